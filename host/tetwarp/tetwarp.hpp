/// @file tetwarp.hpp
/// Includes all public headers of the library target tetwarp::tetwarp.
#pragma once
#include <tetwarp/backend.hpp>
#include <tetwarp/blocks.hpp>
#include <tetwarp/camera.hpp>
#include <tetwarp/certify.hpp>
#include <tetwarp/choices.hpp>
#include <tetwarp/contact.hpp>
#include <tetwarp/contact_analysis.hpp>
#include <tetwarp/contact_problem.hpp>
#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/map_points.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/names.hpp>
#include <tetwarp/page_lock.hpp>
#include <tetwarp/report.hpp>
#include <tetwarp/resample.hpp>
#include <tetwarp/scene.hpp>
#include <tetwarp/scene_parts.hpp>
#include <tetwarp/simulate.hpp>
#include <tetwarp/surface.hpp>
#include <tetwarp/version.hpp>
#include <tetwarp/volume.hpp>
#include <tetwarp/warp.hpp>
#include <tetwarp/warp_operator.hpp>

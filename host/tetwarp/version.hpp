/// @file version.hpp
#pragma once

#define TETWARP_VERSION "0.1.0"

/// @file declare.hpp
/// Additions to CLI11: usage lines, options that take words, one-line messages.
#pragma once
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <tetwarp/backend.hpp>
#include <tetwarp/names.hpp>
#include <utility>
#include <vector>

#include "host/base/nearest_word.hpp"
#include "host/base/parallel.hpp"

namespace tetwarp::cli {

/// Declares the option --quiet: print nothing but errors.
void add_quiet(CLI::App& app, bool& is_quiet);

/// Declares the option --series: of a folder of DICOM images, the UID of the series to read.
/// @param option  its name
CLI::Option* add_series(CLI::App& app, std::string& series, const std::string& option = "--series");

/// Adds a subcommand.
/// @param synopsis  what follows the name in the usage line, e.g. "VOLUME -o MESH"
/// @param examples  shown below the options
CLI::App* add_subcommand(CLI::App& app,
                         const std::string& name,
                         const std::string& description,
                         const std::string& synopsis,
                         const std::string& examples);

/// `text` on one line: line breaks become "; ", other runs of white space one space.
std::string one_line(const std::string& text);

/// "a, b, c".
std::string listed(const std::vector<std::string>& words);

/// Validators of whole numbers that add nothing to the help; their messages name the range.
CLI::Validator between(std::int64_t low, std::int64_t high);
CLI::Validator at_least(std::int64_t low, std::int64_t high = std::numeric_limits<int>::max());

/// Validator of a number above 0 that adds nothing to the help; accepts infinity.
CLI::Validator above_zero();

/// Validators of numbers that add nothing to the help. The second one accepts the words of infinity
/// and NaN, but no number that a float64 cannot hold.
CLI::Validator finite_number();
CLI::Validator representable_number();

/// Throws CLI::ValidationError for a --device beside a back end that uses none.
void check_device(const CLI::App& app, Backend backend);

/// Declares the options --device and --threads.
template <class Number>
void add_device(CLI::App& app, Number& device) {
  app.add_option("--device", device, "CUDA device number [0]")->check(at_least(0))->type_name("N");
}
template <class Number>
void add_threads(CLI::App& app, Number& threads, const std::string& description) {
  app.add_option("--threads", threads, description)->check(between(0, max_threads))->type_name("N");
}

/// Words and their values, in the order in which help shows them.
template <class T>
using Choices = std::vector<std::pair<std::string, T>>;

/// The words of an enum for which names_of() is defined.
template <class T>
Choices<T> choices_of() {
  Choices<T> choices;
  for (const EnumName<T>& entry : names_of<T>()) choices.emplace_back(entry.name, entry.value);
  return choices;
}

template <class T>
std::vector<std::string> words_of(const Choices<T>& choices) {
  std::vector<std::string> words;
  for (const auto& choice : choices) words.push_back(choice.first);
  return words;
}

/// The value of `word`. Throws CLI::ValidationError that lists the words.
template <class T>
T meaning_of(const std::string& option, const std::string& word, const Choices<T>& choices) {
  const auto found = std::find_if(choices.begin(), choices.end(),
                                  [&](const auto& choice) { return choice.first == word; });
  if (found == choices.end()) {
    const std::string remedy = did_you_mean(word, words_of(choices));
    throw CLI::ValidationError(option, "'" + word + "' is not one of " + listed(words_of(choices)) +
                                           (remedy.empty() ? "" : "; " + remedy));
  }
  return found->second;
}

/// Declares an option that takes one of several words; its help lists them.
template <class T>
CLI::Option* add_choice(CLI::App& app,
                        const std::string& option,
                        T& target,
                        const Choices<T>& choices,
                        const std::string& description) {
  return app
      .add_option_function<std::string>(
          option,
          [&target, option, choices](const std::string& word) {
            target = meaning_of(option, word, choices);
          },
          description)
      ->type_name(CLI::detail::join(words_of(choices), "|"));
}

/// Declares an option that takes a comma list of words; calls `apply` with the value of each.
template <class T, class Apply>
void add_word_list(CLI::App& app,
                   const std::string& option,
                   const Choices<T>& choices,
                   Apply apply,
                   const std::string& description) {
  app.add_option_function<std::vector<std::string>>(
         option,
         [option, choices, apply](const std::vector<std::string>& words) {
           for (const std::string& word : words) apply(meaning_of(option, word, choices));
         },
         description)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name(CLI::detail::join(words_of(choices), ","));
}

}  // namespace tetwarp::cli

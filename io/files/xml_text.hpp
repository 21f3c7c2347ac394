/// @file xml_text.hpp
/// Texts in files of XML.
#pragma once
#include <string>

namespace tetwarp {

/// A text as it stands between tags, or in an attribute between double quotes.
inline std::string xml_text(const std::string& text) {
  std::string safe;
  for (const char letter : text) {
    safe += letter == '&'   ? "&amp;"
            : letter == '<' ? "&lt;"
            : letter == '>' ? "&gt;"
            : letter == '"' ? "&quot;"
                            : std::string(1, letter);
  }
  return safe;
}

}  // namespace tetwarp

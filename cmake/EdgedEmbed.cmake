# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Text files as a header of C++: cmake -DFILES="a.css;b.js" -DOUTPUT=a.hpp -P EdgedEmbed.cmake
# defines `const char* const kReportCss` for report.css in namespace edged. For one source to include.
set(CONTENT "#pragma once\n\nnamespace edged {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  string(REGEX MATCHALL "[A-Za-z0-9]+" words ${name})
  set(symbol "k")
  foreach(word IN LISTS words)
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 others)
    string(TOUPPER ${first} first)
    string(APPEND symbol ${first}${others})
  endforeach()
  # Byte by byte: no text of a page can end the literal, and no compiler's limit of its length is met.
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND CONTENT "namespace {\nconst unsigned char ${symbol}Bytes[] = {${bytes}0};\n}\n"
                        "const char* const ${symbol} = reinterpret_cast<const char*>(${symbol}Bytes);\n")
endforeach()
file(WRITE ${OUTPUT} "${CONTENT}}  // namespace edged\n")

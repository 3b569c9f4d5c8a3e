// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/target/print.hpp"

#include <spdlog/fmt/fmt.h>

#include <vector>

namespace edged {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kPoints = 72.0 / 0.0254;  // of a metre
constexpr double kCaption_m = 0.012;       // height of the strip for the text below

struct Page {
  TargetLayout layout;
  double width, height;    // [m]
  Eigen::Vector2d origin;  // of the target, from the lower left of the page
  std::string caption;
};

Page page_of(const TargetSpec& spec) {
  Page page{layout_of(spec), 0.0, 0.0, {}, describe(spec) + ". Print at 100 %, glue it to something flat, measure it."};
  page.origin = {page.layout.margin, page.layout.margin + kCaption_m};
  page.width = page.layout.width + 2.0 * page.layout.margin;
  page.height = page.layout.height + 2.0 * page.layout.margin + kCaption_m;
  return page;
}

}  // namespace

std::string target_svg(const TargetSpec& spec) {
  const Page page = page_of(spec);
  const double width = kMillimetres * page.width, height = kMillimetres * page.height;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.4f}mm\" height=\"{1:.4f}mm\" viewBox=\"0 0 {0:.4f} "
      "{1:.4f}\">\n<rect width=\"{0:.4f}\" height=\"{1:.4f}\" fill=\"#fff\"/>\n<path d=\"",
      width, height);
  for (const TargetPatch& dark : page.layout.dark) {
    const Eigen::Vector2d low = kMillimetres * (dark.low + page.origin),
                          high = kMillimetres * (dark.high + page.origin);
    out += fmt::format("M{:.4f} {:.4f}H{:.4f}V{:.4f}H{:.4f}Z", low.x(), height - low.y(), high.x(), height - high.y(),
                       low.x());
  }
  out += fmt::format(
      "\" fill=\"#000\"/>\n<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"3\" font-family=\"sans-serif\">{}"
      "</text>\n</svg>\n",
      kMillimetres * page.layout.margin, height - 4.0, page.caption);
  return out;
}

std::string target_pdf(const TargetSpec& spec) {
  const Page page = page_of(spec);
  std::string drawing = "0 g\n";
  for (const TargetPatch& dark : page.layout.dark) {
    const Eigen::Vector2d low = kPoints * (dark.low + page.origin), size = kPoints * (dark.high - dark.low);
    drawing += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} re\n", low.x(), low.y(), size.x(), size.y());
  }
  drawing += fmt::format("f\nBT /F1 8 Tf {:.2f} 11 Td ({}) Tj ET\n", kPoints * page.layout.margin, page.caption);
  const std::vector<std::string> objects{
      "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.4f} {:.4f}] /Contents 4 0 R /Resources << /Font << "
                  "/F1 5 0 R >> >> >>",
                  kPoints * page.width, kPoints * page.height),
      fmt::format("<< /Length {} >>\nstream\n{}endstream", drawing.size(), drawing),
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
  std::string out = "%PDF-1.4\n";
  std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010d} 00000 n \n", out.size());
    out += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  const std::size_t at = out.size();
  return out + table +
         fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n", objects.size() + 1, at);
}

}  // namespace edged

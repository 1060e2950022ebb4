// burnish/io/page.h -- a page that tells a story in pictures and numbers: one HTML file that needs nothing else
// SPDX-License-Identifier: Apache-2.0
//
//   Page page("A twin of a car");
//   page.heading("Pose").text("From where the photo was taken.").picture(overlay, "green: both");
//   page.write("twin.html");
#pragma once
#include <burnish/io/photo.h>

namespace burnish {

/// Bytes in base 64 (RFC 4648).
inline std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (int k = 0; k < 4; ++k) out += i + std::size_t(k) > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return out;
}

/// Text as HTML shows it, inside of quotes too.
inline std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}

/// The bytes of a JPEG of a linear picture, without chroma subsampling; values outside 0 .. 1 are clipped.
inline std::string jpeg_of(const Image& image, int quality = 88) {
  std::vector<float> rgb(std::size_t(image.width) * std::size_t(image.height) * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i)
    rgb[i] = detail::to_srgb(std::clamp(image.plane(int(i % 3))[i / 3], 0.0f, 1.0f));
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Compression", "jpeg:" + std::to_string(quality));
  spec.attribute("jpeg:subsampling", "4:4:4");
  return detail::encoded("jpeg", spec, rgb.data());
}

/// Put together from top to bottom; every function gives the page again. Light or dark as the reader's system is.
class Page {
public:
  explicit Page(const std::string& title) : title_(escaped(title)) {}

  /// A chapter begins; it also stands in the list at the top.
  Page& heading(const std::string& name) {
    close();
    const std::string id = std::string("s").append(std::to_string(++sections_));
    contents_ += "<a href=\"#" + id + "\">" + escaped(name) + "</a>\n";
    body_ += "<section id=\"" + id + "\">\n<h2>" + escaped(name) + "</h2>\n";
    open_ = true;
    return *this;
  }
  Page& text(const std::string& words) { return add("<p>" + escaped(words) + "</p>\n"); }
  /// A PNG file, embedded.
  Page& picture(const std::string& path, const std::string& caption) { return figure("png", read_text(path), caption); }
  Page& picture(const Image& linear, const std::string& caption) { return figure("jpeg", jpeg_of(linear), caption); }
  /// Two pictures of one size, over each other; a slider wipes from the first (left) to the second.
  Page& compare(const Image& left, const Image& right, const std::string& caption) {
    scripts_ |= 1;
    return add("<figure class=\"wipe\"><div>" + img("jpeg", jpeg_of(right), caption) +
               img("jpeg", jpeg_of(left), caption) +
               "</div><input type=\"range\" min=\"0\" max=\"1000\" value=\"500\" "
               "aria-label=\"wipe\"><figcaption>" +
               escaped(caption) + "</figcaption></figure>\n");
  }
  /// Pictures (as jpeg_of makes them) that a drag, a slider or the play button flips through, round and round.
  Page& turntable(const std::vector<std::string>& jpegs, const std::string& caption) {
    if (jpegs.empty()) return *this;
    scripts_ |= 2;
    std::string html = "<figure class=\"turn\"><div>";
    for (std::size_t i = 0; i < jpegs.size(); ++i)
      html += "<img alt=\"" + escaped(caption) + "\"" + (i ? "" : " class=\"on\"") + " draggable=\"false\" src=\"" +
              data("image/jpeg", jpegs[i]) + "\">";
    return add(html +
               "</div><p class=\"row\"><button type=\"button\" aria-label=\"play or pause\">&#9654;</button>"
               "<input type=\"range\" min=\"0\" max=\"" +
               std::to_string(jpegs.size() - 1) +
               "\" value=\"0\" "
               "aria-label=\"turn\"></p><figcaption>" +
               escaped(caption) + "</figcaption></figure>\n");
  }
  /// The first row is the head.
  Page& table(const std::vector<std::vector<std::string>>& rows) {
    std::string html = "<div class=\"scroll\"><table>\n";
    for (std::size_t r = 0; r < rows.size(); ++r) {
      html += "<tr>";
      for (const auto& cell : rows[r]) html += (r ? "<td>" : "<th>") + escaped(cell) + (r ? "</td>" : "</th>");
      html += "</tr>\n";
    }
    return add(html + "</table></div>\n");
  }
  /// A number that matters: what it is, how large, and how sure it is ("" where nothing is known).
  struct Number {
    std::string name, value, sure;
  };
  Page& numbers(const std::vector<Number>& list) {
    std::string html = "<div class=\"numbers\">\n";
    for (const Number& n : list)
      html += "<div><b>" + escaped(n.value) + "</b> <i>" + escaped(n.sure) + "</i><br>" + escaped(n.name) + "</div>\n";
    return add(html + "</div>\n");
  }
  /// What took how long, as one bar.
  Page& times(const std::vector<std::pair<std::string, double>>& steps) {
    double sum = 0;
    for (const auto& [name, seconds] : steps) sum += seconds;
    std::string bar = "<div class=\"bar\">", legend = "<p class=\"legend\">";
    for (std::size_t i = 0; i < steps.size(); ++i) {
      char width[32], took[32];
      std::snprintf(width, sizeof width, "%.3f%%", 100 * steps[i].second / std::max(sum, 1e-9));
      std::snprintf(took, sizeof took, " %.1f s", steps[i].second);
      const std::string hue = std::to_string(i * 137 % 360), name = escaped(steps[i].first + took);
      bar += "<span style=\"width:" + std::string(width) + ";--h:" + hue + "\" title=\"" + name + "\"></span>";
      legend += "<span style=\"--h:" + hue + "\">" + name + "</span> ";
    }
    return add(bar + "</div>\n" + legend + "</p>\n");
  }
  /// A file to be saved from the page: inside of it, or, if it has more than `largest` bytes, beside it under its name.
  Page& download(const std::string& path, const std::string& what, std::size_t largest = 4000000) {
    const std::string name = std::filesystem::path(path).filename().string(), bytes = read_text(path);
    const std::string size = bytes.size() < 10000 ? std::to_string(bytes.size()) + " bytes"
                                                  : std::to_string((bytes.size() + 500) / 1000) + " kB";
    return add("<p class=\"file\"><a download=\"" + escaped(name) + "\" href=\"" +
               (bytes.size() > largest ? escaped(name) : data("application/octet-stream", bytes)) + "\">" +
               escaped(name) + "</a> " + escaped(what) + " <small>" + size + "</small></p>\n");
  }
  /// The whole file; Error when it cannot be written.
  void write(const std::string& path) const {
    std::string html =
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width\">\n<title>" +
        title_ + "</title>\n<style>" + style +
        "</style></head>\n"
        "<body><main>\n<h1>" +
        title_ + "</h1>\n";
    if (sections_ > 2) html += "<nav>\n" + contents_ + "</nav>\n";
    html += body_;
    if (open_) html += "</section>\n";
    html += "</main>\n";
    if (scripts_ & 1) html += std::string("<script>") + wipe + "</script>\n";
    if (scripts_ & 2) html += std::string("<script>") + turn + "</script>\n";
    write_text(path, html + "</body></html>\n");
  }

private:
  std::string title_, contents_, body_;
  int sections_ = 0, scripts_ = 0;
  bool open_ = false;

  Page& add(const std::string& html) {
    body_ += html;
    return *this;
  }
  void close() {
    if (open_) body_ += "</section>\n";
  }
  static std::string data(const std::string& type, const std::string& bytes) {
    return "data:" + type + ";base64," + base64(bytes);
  }
  static std::string img(const std::string& type, const std::string& bytes, const std::string& caption) {
    return "<img alt=\"" + escaped(caption) + "\" src=\"" + data("image/" + type, bytes) + "\">";
  }
  Page& figure(const std::string& type, const std::string& bytes, const std::string& caption) {
    return add("<figure>" + img(type, bytes, caption) + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n");
  }

  static constexpr const char* style =
      ":root{color-scheme:light dark;--paper:#fbfaf8;--ink:#22252a;--faint:#6b7078;--line:#dddad4;--accent:#b3402e}"
      "@media(prefers-color-scheme:dark){:root{--paper:#15171a;--ink:#dcdee2;--faint:#90959d;--line:#2d3137;"
      "--accent:#f08a70}}"
      "body{font:16px/1.55 system-ui,sans-serif;margin:0;background:var(--paper);color:var(--ink)}"
      "main{max-width:1080px;margin:0 auto;padding:2.5em 1.25em 5em}"
      "h1{font-size:2em;line-height:1.2;margin:0 0 .6em}h2{font-size:1.3em;margin:0 0 .6em}"
      "section{border-top:1px solid var(--line);margin-top:2.2em;padding-top:1.4em}"
      "nav{display:flex;flex-wrap:wrap;gap:.3em 1.2em}a{color:var(--accent)}nav a{text-decoration:none}"
      "p{max-width:46em;margin:.7em 0;overflow-wrap:anywhere}"
      "img{max-width:100%;height:auto;border-radius:6px;display:block}figure{margin:1.2em 0}"
      "figcaption,small,.legend{color:var(--faint);font-size:.88em}figcaption{margin-top:.4em}"
      ".scroll{overflow-x:auto}table{border-collapse:collapse;margin:1em "
      "0;font-variant-numeric:tabular-nums;font-size:.93em}"
      "td,th{padding:.22em 1.3em .22em 0;text-align:left;border-bottom:1px solid "
      "var(--line)}th{color:var(--faint);font-weight:500}"
      ".numbers{display:flex;flex-wrap:wrap;gap:1em 2.4em;margin:1em 0;color:var(--faint);font-size:.9em}"
      ".numbers b{font-size:1.6em;font-weight:600;color:var(--ink)}.numbers i{font-style:normal}"
      ".bar{display:flex;height:1.1em;border-radius:5px;overflow:hidden;margin:1em 0 .4em}"
      ".bar span,.legend span:before{background:hsl(var(--h) 45% 55%)}"
      ".legend span{margin-right:1em;white-space:nowrap}"
      ".legend "
      "span:before{content:\"\";display:inline-block;width:.7em;height:.7em;border-radius:2px;margin-right:.4em}"
      ".wipe div{position:relative}.wipe img+img{position:absolute;inset:0;clip-path:inset(0 50% 0 0)}"
      "input[type=range]{width:100%;accent-color:var(--accent);margin:.5em 0}"
      ".turn div{position:relative;cursor:grab;touch-action:pan-y}.turn img{width:100%;visibility:hidden}"
      ".turn img+img{position:absolute;inset:0}.turn img.on{visibility:visible}"
      ".wipe{max-width:800px}.wipe img{width:100%}.row{display:flex;gap:.8em;max-width:none}.row "
      "button{font-size:1em;width:2.8em;padding:0;white-space:nowrap;border:1px solid var(--line);"
      "border-radius:6px;background:none;color:var(--ink)}";
  static constexpr const char* wipe =
      "for(const f of document.querySelectorAll('.wipe')){const r=f.querySelector('input'),d=f.querySelector('div'),"
      "i=d.lastElementChild;const show=()=>i.style.clipPath='inset(0 '+(100-r.value/10)+'% 0 0)';r.oninput=show;"
      "const to=e=>{if(e.buttons){const b=d.getBoundingClientRect();r.value=1000*(e.clientX-b.left)/b.width;show()}};"
      "d.onpointermove=to;d.onpointerdown=to;d.ondragstart=()=>false}";
  static constexpr const char* turn =
      "for(const f of document.querySelectorAll('.turn')){const d=f.querySelector('div'),m=[...d.children],"
      "r=f.querySelector('input'),b=f.querySelector('button');let at=0,timer=0,from=null;"
      "const "
      "show=i=>{m[at].className='';at=((Math.round(i)%m.length)+m.length)%m.length;m[at].className='on';r.value=at};"
      "const stop=()=>{clearInterval(timer);timer=0;b.innerHTML='&#9654;'};"
      "const play=()=>{timer=setInterval(()=>show(at+1),4800/m.length);b.innerHTML='&#10074;&#10074;'};"
      "b.onclick=()=>timer?stop():play();r.oninput=()=>{stop();show(+r.value)};"
      "d.onpointerdown=e=>{stop();from=[e.clientX,at];d.setPointerCapture(e.pointerId)};"
      "d.onpointermove=e=>{if(from)show(from[1]+(e.clientX-from[0])*1.5*m.length/d.clientWidth)};"
      "d.onpointerup=d.onpointercancel=()=>from=null;"
      "if(!matchMedia('(prefers-reduced-motion:reduce)').matches)play()}";
};

}  // namespace burnish

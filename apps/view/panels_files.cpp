// The file dialogue: folders, filters by format, names.
#include <imgui.h>

#include <algorithm>
#include <cstring>

#include "apps/view/panels.hpp"

namespace palpate {

namespace {

constexpr const char* kFiles = "Files";

template <std::size_t n>
void write(std::array<char, n>& text, const std::string& value) {
  text.fill(0);
  std::memcpy(text.data(), value.data(), std::min(value.size(), n - 1));
}

const char* verbOf(FileTask task, bool replaces) {
  if (task == FileTask::open) return "Open##files";
  if (replaces) return "Replace##files";
  return task == FileTask::saveAs ? "Save##files" : "Export##files";
}

std::string sizeOf(std::uintmax_t bytes) {
  constexpr double kKilo = 1000;
  if (bytes < 1000) return fmt::format("{} B", bytes);
  if (bytes < 1'000'000) return fmt::format("{:.0f} kB", static_cast<double>(bytes) / kKilo);
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / (kKilo * kKilo));
}

// What is written gets the ending of the format that is chosen, unless its name has one.
std::filesystem::path placeToWrite(const FileBrowser& browser, const std::string& name) {
  const FileBrowser::Filter& filter = browser.filters()[browser.filter()];
  const std::filesystem::path place = browser.placeOf(name);
  return place.has_extension() || filter.endings.empty()
             ? place
             : std::filesystem::path(place.string() + filter.endings.front());
}

}  // namespace

void Panels::browse(FileTask task, const ViewStatus& status) {
  if (task != FileTask::open && !status.session) return;
  const std::filesystem::path beside = task == FileTask::saveAs ? status.saveFile : status.model;
  files_.emplace(Files{
      .task = task,
      .browser = FileBrowser(beside.parent_path(),
                             task == FileTask::open ? filtersToOpen() : filtersToSave(task == FileTask::exportMesh))});
  write(files_->folder, files_->browser.folder().string());
  if (task == FileTask::saveAs) write(files_->name, beside.filename().string());
  if (task == FileTask::exportMesh) write(files_->name, beside.stem().string() + "-mesh");
}

// Whether a file was asked for by a double click.
bool Panels::drawEntries() {
  FileBrowser& browser = files_->browser;
  bool chosen = false;
  std::optional<std::string> into;
  constexpr double kBesides_em = 12;  // what stands above and below them
  const float room = ImGui::GetIO().DisplaySize.y - em(kBesides_em);
  ImGui::BeginChild("entries", {0, std::clamp(room, em(4), em(16))}, true);
  for (const FileBrowser::Entry& entry : browser.entries()) {
    const std::string shown = entry.isFolder ? entry.name + "/" : entry.name;
    const bool is = !entry.isFolder && entry.name == files_->name.data();
    if (noted(shown, ImGui::Selectable(shown.c_str(), is, ImGuiSelectableFlags_AllowDoubleClick))) {
      if (entry.isFolder)
        into = entry.name;
      else
        write(files_->name, entry.name);
      chosen = !entry.isFolder && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
    }
    if (entry.isFolder) continue;
    const std::string size = sizeOf(entry.bytes);
    ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(size.c_str()).x);
    ImGui::TextDisabled("%s", size.c_str());
  }
  if (browser.entries().empty()) ImGui::TextDisabled("nothing of this kind is here");
  ImGui::EndChild();
  if (into) browser.go(*into);
  return chosen;
}

void Panels::drawFiles(const ViewStatus& status, ViewRequests& requests) {
  if (!files_) return;
  if (!ImGui::IsPopupOpen(kFiles)) ImGui::OpenPopup(kFiles);
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(em(36), display.x - em(1)), 0});
  if (!ImGui::BeginPopupModal(kFiles, nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) return;
  FileBrowser& browser = files_->browser;
  const std::filesystem::path before = browser.folder();
  if (button("Up")) browser.goUp();
  ImGui::SameLine();
  ImGui::PushItemWidth(-1);
  if (field("folder", files_->folder)) browser.go(files_->folder.data());
  ImGui::PopItemWidth();
  // Folders of what was open lately.
  std::vector<std::string> lately;
  for (const std::span<const std::string> files : {status.recent, status.gone})
    for (const std::string& file : files)
      if (const std::string folder = std::filesystem::path(file).parent_path().string();
          !folder.empty() && std::ranges::find(lately, folder) == lately.end())
        lately.push_back(folder);
  if (!lately.empty() && ImGui::BeginCombo("##lately", "recent folders")) {
    for (const std::string& folder : lately)
      if (noted(folder, ImGui::Selectable(folder.c_str()))) browser.go(folder);
    ImGui::EndCombo();
  }
  noted("recent folders", false);
  bool chosen = drawEntries();
  if (!browser.failure().empty()) ImGui::TextWrapped("%s", browser.failure().c_str());
  ImGui::PushItemWidth(std::min(em(20), 0.6f * ImGui::GetContentRegionAvail().x));
  chosen |= field("name", files_->name);
  ImGui::PopItemWidth();
  ImGui::SameLine();
  ImGui::PushItemWidth(-1);
  if (ImGui::BeginCombo("##format", browser.filters()[browser.filter()].name.c_str())) {
    for (std::size_t k = 0; k < browser.filters().size(); ++k) {
      const std::string name = browser.filters()[k].name;
      if (noted(name, ImGui::Selectable(name.c_str(), k == browser.filter()))) browser.choose(k);
    }
    ImGui::EndCombo();
  }
  noted("format", false);
  ImGui::PopItemWidth();
  const bool opens = files_->task == FileTask::open, named = files_->name[0] != 0;
  const std::filesystem::path place =
      opens ? browser.placeOf(files_->name.data()) : placeToWrite(browser, files_->name.data());
  std::error_code ignored;
  const bool isThere = named && std::filesystem::exists(place, ignored);
  ImGui::BeginDisabled(!named || (opens && !isThere));
  const bool pressed = button(verbOf(files_->task, isThere));
  ImGui::EndDisabled();
  std::filesystem::path result;
  if ((pressed || chosen) && named && (!opens || isThere)) result = place;
  if (opens && browser.isModel()) {
    ImGui::SameLine();
    if (button("Open this folder")) result = browser.folder();
  }
  ImGui::SameLine();
  const bool cancelled = button("Cancel##files") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
  if (browser.folder() != before) write(files_->folder, browser.folder().string());
  if (!result.empty()) {
    (opens                              ? requests.open
     : files_->task == FileTask::saveAs ? requests.saveAs
                                        : requests.exportMesh) = result.string();
  }
  if (!result.empty() || cancelled) {
    ImGui::CloseCurrentPopup();
    files_.reset();
  }
  ImGui::EndPopup();
}

}  // namespace palpate

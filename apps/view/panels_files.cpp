// The file dialogue: folders, filters by format, names.
#include <imgui.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "apps/view/panels.hpp"

namespace palpate {

namespace {

// Title by task; ### keeps the same id for ImGui.
const char* titleOf(FileTask task) {
  if (task == FileTask::open) return "Open a model###files";
  if (task == FileTask::saveAs) return "Save the points as###files";
  if (task == FileTask::exportSelection) return "Export the selected points as###files";
  if (task == FileTask::separate) return "Export the selected points, and remove them###files";
  return "Export the triangles as###files";
}

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

// Adds the ending of the chosen format to a name without an ending.
std::filesystem::path placeToWrite(const FileBrowser& browser, const std::string& name) {
  const FileBrowser::Filter& filter = browser.filters()[browser.filter()];
  const std::filesystem::path place = browser.placeOf(name);
  return place.has_extension() || filter.endings.empty()
             ? place
             : std::filesystem::path(place.string() + filter.endings.front());
}

}  // namespace

std::string whatIsReplaced(const std::filesystem::path& file, const ViewStatus& status) {
  std::error_code ignored;
  return std::filesystem::equivalent(file, status.model, ignored)
             ? "This is the file of the open model: the present points replace its contents."
             : "A file of this name exists.";
}

void Panels::openFiles(FileTask task, const ViewStatus& status) {
  if (task != FileTask::open && !status.session) return;
  const std::filesystem::path beside = task == FileTask::saveAs ? status.saveFile : status.model;
  files_.emplace(Files{
      .task = task,
      .browser = FileBrowser(beside.parent_path(),
                             task == FileTask::open ? filtersToOpen() : filtersToSave(task == FileTask::exportMesh))});
  write(files_->folder, files_->browser.folder().string());
  if (task == FileTask::saveAs) write(files_->name, beside.filename().string());
  if (task == FileTask::exportMesh) write(files_->name, beside.stem().string() + "-mesh");
  if (task == FileTask::exportSelection || task == FileTask::separate)
    write(files_->name, beside.stem().string() + "-part" + beside.extension().string());
}

// Returns whether a file was double-clicked.
bool Panels::drawEntries() {
  FileBrowser& browser = files_->browser;
  bool chosen = false;
  std::optional<std::string> into;
  constexpr double kBesides_em = 12;  // height of the controls above and below the list
  const float room = ImGui::GetIO().DisplaySize.y - em(kBesides_em);
  ImGui::BeginChild("entries", {0, std::clamp(room, em(4), em(16))}, true);
  for (const FileBrowser::Entry& entry : browser.entries()) {
    const std::string shown = entry.isFolder ? entry.name + "/" : entry.name;
    const bool is = entry.name == files_->name.data();
    if (noted(shown, ImGui::Selectable(shown.c_str(), is, ImGuiSelectableFlags_AllowDoubleClick))) {
      if (entry.isFolder)
        into = entry.name;
      else
        write(files_->name, entry.name);
      chosen = !entry.isFolder && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
    }
    if (is && std::exchange(files_->seen, entry.name) != entry.name && !ImGui::IsItemVisible()) ImGui::SetScrollHereY();
    if (entry.isFolder) continue;
    const bool isLit = is || ImGui::IsItemHovered();
    const std::string size = sizeOf(entry.bytes);
    ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(size.c_str()).x);
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(isLit ? ImGuiCol_Text : ImGuiCol_TextDisabled));
    ImGui::TextUnformatted(size.c_str());
    ImGui::PopStyleColor();
  }
  if (browser.entries().empty()) ImGui::TextDisabled("no files of this kind");
  ImGui::EndChild();
  if (into) browser.go(*into);
  return chosen;
}

// Has the keyboard focus at first: a name is typed, or an entry of the list is chosen with the arrow keys. Returns
// whether Enter was pressed.
bool Panels::drawName() {
  auto step = [this](bool down) -> std::optional<std::string> {
    const auto entries = files_->browser.entries();
    if (entries.empty()) return std::nullopt;
    const auto now = std::ranges::find(entries, std::string(files_->name.data()), &FileBrowser::Entry::name);
    if (now == entries.end()) return (down ? entries.front() : entries.back()).name;
    if (now == (down ? entries.end() - 1 : entries.begin())) return std::nullopt;
    return (down ? now + 1 : now - 1)->name;
  };
  using Step = decltype(step);
  const auto onArrow = [](ImGuiInputTextCallbackData* data) {
    const auto name = (*static_cast<Step*>(data->UserData))(data->EventKey == ImGuiKey_DownArrow);
    if (!name) return 0;
    data->DeleteChars(0, data->BufTextLen);
    data->InsertChars(0, name->c_str());
    return 0;
  };
  ImGui::PushItemWidth(std::min(em(20), 0.6f * ImGui::GetContentRegionAvail().x));
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  constexpr ImGuiInputTextFlags kFlags =
      ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_CallbackHistory;
  const bool entered = noted("name", ImGui::InputTextWithHint("##name", "name", files_->name.data(),
                                                              files_->name.size(), kFlags, onArrow, &step));
  ImGui::PopItemWidth();
  return entered;
}

void Panels::drawFiles(const ViewStatus& status) {
  if (const auto task = std::exchange(browses_, {})) openFiles(*task, status);
  if (!files_) return;
  const char* const title = titleOf(files_->task);
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(em(36), display.x - em(1)), 0});
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) return;
  FileBrowser& browser = files_->browser;
  const std::filesystem::path before = browser.folder();
  if (button("Up")) browser.goUp();
  ImGui::SameLine();
  ImGui::PushItemWidth(-1);
  const bool went = field("folder", files_->folder);
  if (went) browser.go(files_->folder.data());
  ImGui::PopItemWidth();
  // Folders of recent models.
  std::vector<std::string> lately;
  for (const std::span<const std::string> files : {status.recent, status.gone})
    for (const std::string& file : files)
      if (const std::string folder = std::filesystem::path(file).parent_path().string();
          !folder.empty() && std::ranges::find(lately, folder) == lately.end())
        lately.push_back(folder);
  bool chooses = false;  // a list is open: Enter belongs to it
  if (!lately.empty() && ImGui::BeginCombo("##lately", "recent folders")) {
    chooses = true;
    for (const std::string& folder : lately)
      if (noted(folder, ImGui::Selectable(folder.c_str()))) browser.go(folder);
    ImGui::EndCombo();
  }
  noted("recent folders", false);
  bool chosen = drawEntries();
  if (!browser.failure().empty()) ImGui::TextWrapped("%s", browser.failure().c_str());
  chosen |= drawName();
  ImGui::SameLine();
  ImGui::PushItemWidth(-1);
  if (ImGui::BeginCombo("##format", browser.filters()[browser.filter()].name.c_str())) {
    chooses = true;
    for (std::size_t k = 0; k < browser.filters().size(); ++k) {
      const std::string name = browser.filters()[k].name;
      if (noted(name, ImGui::Selectable(name.c_str(), k == browser.filter()))) browser.choose(k);
    }
    ImGui::EndCombo();
  }
  noted("format", false);
  ImGui::PopItemWidth();
  const auto pressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), false); };
  const bool isFree = !went && !chooses && !ImGui::IsAnyItemActive();
  chosen |= isFree && (pressed(ImGuiKey_Enter) || pressed(ImGuiKey_KeyPadEnter));
  const bool ends = drawFilesButtons(status, chosen);
  if (browser.folder() != before) write(files_->folder, browser.folder().string());
  if (ends) {
    ImGui::CloseCurrentPopup();
    files_.reset();
  }
  ImGui::EndPopup();
}

// `chosen`: acts as a press of the first button. Returns whether the dialogue ends.
bool Panels::drawFilesButtons(const ViewStatus& status, bool chosen) {
  FileBrowser& browser = files_->browser;
  const bool opens = files_->task == FileTask::open, named = files_->name[0] != 0;
  const std::filesystem::path place =
      opens ? browser.placeOf(files_->name.data()) : placeToWrite(browser, files_->name.data());
  std::error_code ignored;
  const bool isThere = named && std::filesystem::exists(place, ignored);
  const bool isFolder = isThere && std::filesystem::is_directory(browser.placeOf(files_->name.data()), ignored);
  if (isThere && !isFolder && !opens) ImGui::TextWrapped("%s", whatIsReplaced(place, status).c_str());
  const bool isPossible = named && (!opens || isThere);
  ImGui::BeginDisabled(!isPossible);
  chosen |= button(verbOf(files_->task, isThere && !isFolder));
  ImGui::EndDisabled();
  std::filesystem::path result;
  if (chosen && isPossible && !isFolder) result = place;
  if (chosen && isFolder) {
    browser.go(files_->name.data());
    files_->name.fill(0);
  }
  if (opens && browser.isModel()) {
    ImGui::SameLine();
    if (button("Open this folder")) result = browser.folder();
  }
  ImGui::SameLine();
  const bool cancelled = button("Cancel##files") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
  return post(!result.empty(), FileCommand{files_->task, result.string()}) || cancelled;
}

}  // namespace palpate

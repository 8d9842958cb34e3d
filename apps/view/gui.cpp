#include "apps/view/gui.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "apps/cli/font.hpp"
#include "apps/view/theme.hpp"
#include "engine/core/characters.hpp"

namespace palpate {

namespace {

constexpr float kFontHeight_px = 14;

constexpr std::array<std::pair<ImGuiKey, int>, 22> kKeys{{{ImGuiKey_Tab, GLFW_KEY_TAB},
                                                          {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
                                                          {ImGuiKey_RightArrow, GLFW_KEY_RIGHT},
                                                          {ImGuiKey_UpArrow, GLFW_KEY_UP},
                                                          {ImGuiKey_DownArrow, GLFW_KEY_DOWN},
                                                          {ImGuiKey_PageUp, GLFW_KEY_PAGE_UP},
                                                          {ImGuiKey_PageDown, GLFW_KEY_PAGE_DOWN},
                                                          {ImGuiKey_Home, GLFW_KEY_HOME},
                                                          {ImGuiKey_End, GLFW_KEY_END},
                                                          {ImGuiKey_Insert, GLFW_KEY_INSERT},
                                                          {ImGuiKey_Delete, GLFW_KEY_DELETE},
                                                          {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
                                                          {ImGuiKey_Space, GLFW_KEY_SPACE},
                                                          {ImGuiKey_Enter, GLFW_KEY_ENTER},
                                                          {ImGuiKey_Escape, GLFW_KEY_ESCAPE},
                                                          {ImGuiKey_KeyPadEnter, GLFW_KEY_KP_ENTER},
                                                          {ImGuiKey_A, GLFW_KEY_A},
                                                          {ImGuiKey_C, GLFW_KEY_C},
                                                          {ImGuiKey_V, GLFW_KEY_V},
                                                          {ImGuiKey_X, GLFW_KEY_X},
                                                          {ImGuiKey_Y, GLFW_KEY_Y},
                                                          {ImGuiKey_Z, GLFW_KEY_Z}}};

constexpr unsigned kFirstLatin = 0x20, kLastLatin = 0xff;

// The colours that ImGui has names for.
const std::vector<std::pair<Tone, std::vector<ImGuiCol>>> kStyle{
    {Tone::text, {ImGuiCol_Text}},
    {Tone::faint, {ImGuiCol_TextDisabled}},
    {Tone::panel, {ImGuiCol_WindowBg, ImGuiCol_PopupBg}},
    {Tone::field, {ImGuiCol_FrameBg}},
    {Tone::fieldHovered, {ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive}},
    {Tone::button, {ImGuiCol_Button}},
    {Tone::buttonHovered, {ImGuiCol_ButtonHovered}},
    {Tone::chosen,
     {ImGuiCol_ButtonActive, ImGuiCol_TextSelectedBg, ImGuiCol_PlotHistogram, ImGuiCol_SliderGrab,
      ImGuiCol_SliderGrabActive}},
    {Tone::header, {ImGuiCol_Header, ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TitleBgCollapsed}},
    {Tone::headerHovered, {ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive}},
    {Tone::accent, {ImGuiCol_CheckMark, ImGuiCol_PlotLines}}};

// Whether the topmost popup is a list or another one that a click beside it closes, and not a modal question.
bool hasList() {
  const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
  return !open.empty() && open.back().Window && !(open.back().Window->Flags & ImGuiWindowFlags_Modal);
}

}  // namespace

Gui::Gui(Window& window) : window_(window) {
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // panel positions are fixed
  io.BackendRendererName = "palpate";
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;  // many small pictures have many vertices (gather())
  for (const auto& [key, number] : kKeys) io.KeyMap[key] = number;
  io.ClipboardUserData = this;
  io.SetClipboardTextFn = [](void* self, const char* text) { static_cast<Gui*>(self)->window_.setClipboard(text); };
  io.GetClipboardTextFn = [](void* self) {
    auto& gui = *static_cast<Gui*>(self);
    gui.clipboard_ = gui.window_.clipboard();
    return gui.clipboard_.c_str();
  };
  // Glyphs are aligned to pixels and lines are drawn as triangles, so that the texture needs no interpolation.
  io.Fonts->Flags |= ImFontAtlasFlags_NoBakedLines;
  applyLook();
}

Gui::~Gui() { ImGui::DestroyContext(); }

void Gui::makeFont() {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  static_assert(std::is_same_v<ImWchar, unsigned short>);
  ranges_ = {kFirstLatin, kLastLatin};
  for (const unsigned letter : letters_) {
    ranges_.push_back(static_cast<ImWchar>(letter));
    ranges_.push_back(static_cast<ImWchar>(letter));
  }
  ranges_.push_back(0);
  addFont(atlas, kFontHeight_px * static_cast<float>(scale_), Texels::fine, ranges_);
  unsigned char* texels = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&texels, &width, &height);
  texture_ = texels;
  texture_px_ = UVec2(width, height);
  lacksLetters_ = false;
  ++fontVersion_;
}

void Gui::noteLetters(std::string_view text) {
  constexpr unsigned kLast = std::numeric_limits<ImWchar>::max();
  if (std::ranges::none_of(text, [](char c) { return static_cast<unsigned char>(c) > 0x7f; })) return;  // as most are
  for (const char32_t letter : charactersOf(text))
    if (letter > kLastLatin && letter <= kLast) lacksLetters_ |= letters_.insert(static_cast<unsigned>(letter)).second;
}

void Gui::setLook(bool dark, int text_percent) {
  dark_ = dark;
  text_percent_ = text_percent;
}

void Gui::applyLook() {
  const double scale = window_.scale() * text_percent_ / 100;
  if (scale != std::exchange(scale_, scale) || !texture_ || lacksLetters_) makeFont();
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  dark_ ? ImGui::StyleColorsDark() : ImGui::StyleColorsLight();
  for (const auto& [tone, colors] : kStyle)
    for (const ImGuiCol color : colors) style.Colors[color] = ImGui::ColorConvertU32ToFloat4(inkOf(tone, dark_));
  style.WindowRounding = 6;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = 4;
  // White boxes on a white panel, and that on a white background, are visible by their borders only.
  style.FrameBorderSize = style.WindowBorderSize = dark_ ? 0 : 1;
  style.FramePadding = {6, 3};
  style.ItemSpacing = {6, 5};
  style.DisabledAlpha = kDisabledOpacity;
  style.ScaleAllSizes(static_cast<float>(scale_));
}

bool Gui::feed(const WindowEvent& event) {
  ImGuiIO& io = ImGui::GetIO();
  if (const auto* key = std::get_if<KeyEvent>(&event); key && key->down && key->key == GLFW_KEY_ESCAPE && hasList()) {
    closesList_ = true;
    return true;
  }
  if (const auto* key = std::get_if<KeyEvent>(&event)) {
    if (key->key >= 0 && key->key < IM_ARRAYSIZE(io.KeysDown)) io.KeysDown[key->key] = key->down;
    const auto isDown = [&](int left, int right) { return io.KeysDown[left] || io.KeysDown[right]; };
    io.KeyCtrl = isDown(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    io.KeyShift = isDown(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    io.KeyAlt = isDown(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
  } else if (const auto* text = std::get_if<TextEvent>(&event)) {
    io.AddInputCharacter(text->character);
  } else if (const auto* mouse = std::get_if<MouseEvent>(&event)) {
    io.MousePos = {static_cast<float>(mouse->place_px.x), static_cast<float>(mouse->place_px.y)};
  } else if (const auto* button = std::get_if<ButtonEvent>(&event)) {
    io.MouseDown[static_cast<int>(button->button)] = button->down;
  } else if (const auto* wheel = std::get_if<WheelEvent>(&event)) {
    io.MouseWheel += static_cast<float>(wheel->away);
    io.MouseWheelH += static_cast<float>(wheel->right);
  }
  return false;
}

void Gui::begin(const UVec2& size_px, double dt_s) {
  applyLook();
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(size_px.x), static_cast<float>(size_px.y)};
  io.DeltaTime = static_cast<float>(std::max(dt_s, 1e-4));
  ImGui::NewFrame();
  if (std::exchange(closesList_, false) && hasList())
    ImGui::ClosePopupToLevel(ImGui::GetCurrentContext()->OpenPopupStack.Size - 1, true);
}

PanelShapes Gui::end() {
  ImGui::Render();
  gather();
  return {vertices_, triangles_, clips_};
}

void Gui::gather() {
  vertices_.clear();
  triangles_.clear();
  clips_.clear();
  const ImDrawData& data = *ImGui::GetDrawData();
  for (const ImDrawList* list : std::span(data.CmdLists, static_cast<std::size_t>(data.CmdListsCount))) {
    const auto base = static_cast<std::uint32_t>(vertices_.size());
    for (const ImDrawVert& vertex : list->VtxBuffer)
      vertices_.push_back({{vertex.pos.x, vertex.pos.y}, {vertex.uv.x, vertex.uv.y}, vertex.col});
    for (const ImDrawCmd& command : list->CmdBuffer) {
      if (command.UserCallback) continue;
      const auto clip = static_cast<std::uint32_t>(clips_.size());
      clips_.push_back({command.ClipRect.x, command.ClipRect.y, command.ClipRect.z, command.ClipRect.w});
      const auto at = [&](unsigned index) {
        return base + command.VtxOffset + list->IdxBuffer[static_cast<int>(command.IdxOffset + index)];
      };
      for (unsigned i = 0; i + 2 < command.ElemCount; i += 3)
        triangles_.push_back({{at(i), at(i + 1), at(i + 2)}, clip});
    }
  }
}

bool Gui::wantsMouse() const { return ImGui::GetIO().WantCaptureMouse; }
// The state after the last frame: io.WantTextInput would be one frame late.
bool Gui::wantsKeys() const { return ImGui::GetCurrentContext()->WantTextInputNextFrame == 1; }
bool Gui::isBusy() const { return ImGui::IsAnyItemActive(); }

}  // namespace palpate

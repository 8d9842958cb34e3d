// The icons of the tools: lines in a square of 16 by 16 units, drawn by the panels.
#pragma once

#include <array>
#include <string_view>

struct ImDrawList;
struct ImVec2;

namespace palpate {

/// The commands are letters with numbers in units from the top left: M x y begins a line, L x y continues it, Z closes
/// it, O x y r is a circle, D x y r a disc. Draws them in the square at `corner` with that side, pixels.
void drawIcon(ImDrawList& list, std::string_view icon, const ImVec2& corner, float side, unsigned color);

namespace icon {

inline constexpr std::string_view kSculpt = "M3 13 L5 8 L11 2 L14 5 L8 11 Z M5 8 L8 11",
                                  kSelect = "M4 2 L4 13 L7 10 L9 14 L11 13 L9 9 L13 9 Z",
                                  kLook = "M1 8 L4 5 L8 4 L12 5 L15 8 L12 11 L8 12 L4 11 Z D8 8 2",
                                  kMeasure = "M2 11 L11 2 L14 5 L5 14 Z M5 8 L6.5 9.5 M8 5 L9.5 6.5",
                                  kFeel = "M8 9 L8 1 M5.5 6.5 L8 9 L10.5 6.5 M1 12 L5 12 L8 13 L11 12 L15 12";

/// In the order of kBrushes.
inline constexpr std::array<std::string_view, 7> kOfBrushes{
    "M8 1 L8 8 M5.5 5.5 L8 8 L10.5 5.5 M1 9 L4 9 L5.5 12 L8 13.5 L10.5 12 L12 9 L15 9",
    "M1 9 L4 9 L5 12 L8 14 L11 12 L12 9 L15 9 O8 6 3.5",
    "M1 13 L4 13 L5 9 L8 7 L11 9 L12 13 L15 13 M8 5 L8 1 M6 3 L8 1 L10 3",
    "M1 4 L3 2 L5 5 L7 2 L9 5 L11 2 L13 5 L15 3 M1 12 L5 11 L10 11 L15 12 M8 6.5 L8 9",
    "M5 15 L3 10 L2 6 L4 6 L5 9 L5 3 L7 3 L7 8 L8 2 L10 2 L10 8 L11 4 L13 4 L13 11 L11 15 Z",
    "M13 2 L8 9 L10 11 L15 4 Z M8 9 L4 11 L3 14 L8 13 L10 11",
    "M1 13 L15 13 M3 13 L4 9 L12 9 L13 13 M8 1 L8 6.5 M5.5 4 L8 6.5 L10.5 4"};

/// In the order of kSelectShapes.
inline constexpr std::array<std::string_view, 12> kOfShapes{
    "M2 4 L14 4 L14 12 L2 12 Z",
    "M6 12 L3 10 L2 6 L5 3 L10 2 L14 5 L13 9 L9 11 L6 10 L5 13 L7 15",
    "M3 13 L2 5 L9 2 L14 7 L10 13 Z D3 13 1.3 D2 5 1.3 D9 2 1.3 D14 7 1.3 D10 13 1.3",
    "O8 7 5 D8 7 1.2 M1 14 L15 14",
    "M3 8 L8 3 L13 8 L8 13 Z M3 8 L13 8 M8 3 L6 1 M14 10 L15 13 L13 13 Z",
    "D4 4 2 D12 4 2 D4 12 2 O12 12 2",
    "M2 3 L8 3 L14 9 L9 14 L2 8 Z D5 6 1",
    "M3 8 L13 8 L13 14 L3 14 Z M5 8 L5 4 L8 2 L11 4 L11 8 D8 11 1.3",
    "M2 5 L8 2 L14 5 L14 11 L8 14 L2 11 Z M2 5 L8 8 L14 5 M8 8 L8 14",
    "O8 8 6 M2 8 L5 10 L11 10 L14 8",
    "M1 12 L6 7 L15 7 L10 12 Z M8 9 L8 2 M6.5 3.5 L8 2 L9.5 3.5",
    "M8 1 L8 15 M1 8 L15 8 M6.5 2.5 L8 1 L9.5 2.5 M6.5 13.5 L8 15 L9.5 13.5 M2.5 6.5 L1 8 L2.5 9.5 M13.5 6.5 L15 8 "
    "L13.5 9.5"};

inline constexpr std::string_view kReset = "M1 8 L8 2 L15 8 M3 7 L3 14 L13 14 L13 7",
                                  kOrthographic = "M2 5 L10 5 L10 13 L2 13 Z M2 5 L6 2 L14 2 L10 5 M14 2 L14 10 L10 13",
                                  kPicture = "M1 4 L5 4 L6 2 L10 2 L11 4 L15 4 L15 13 L1 13 Z O8 8.5 2.7",
                                  kAxisX = "M4 3 L12 13 M12 3 L4 13", kAxisY = "M4 3 L8 8 L12 3 M8 8 L8 13",
                                  kAxisZ = "M4 3 L12 3 L4 13 L12 13";
inline constexpr std::string_view kShift = "M8 1 L15 9 L11 9 L11 14 L5 14 L5 9 L1 9 Z", kControl = "M2 10 L8 3 L14 10",
                                  kUp = "M2 11 L8 5 L14 11", kDown = "M2 5 L8 11 L14 5";
/// A mouse, and its left, middle and right button.
inline constexpr std::string_view kMouse = "M4 6 L5 3 L8 2 L11 3 L12 6 L12 11 L11 14 L8 15 L5 14 L4 11 Z M4 7 L12 7";

}  // namespace icon

}  // namespace palpate

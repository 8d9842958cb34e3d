// The panels of the window: they show the state and change the settings.
#pragma once

#include <deque>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <vector>

#include "apps/view/brush_in_hand.hpp"
#include "apps/view/commands.hpp"
#include "apps/view/file_browser.hpp"
#include "apps/view/gui.hpp"
#include "apps/view/link_history.hpp"
#include "apps/view/named_texts.hpp"
#include "apps/view/place_info.hpp"
#include "apps/view/select_tool.hpp"
#include "apps/view/settings.hpp"
#include "apps/view/theme.hpp"
#include "apps/view/thumbnails.hpp"
#include "engine/io/memory_need.hpp"
#include "haptics/devices/haptic_device.hpp"

struct ImVec2;

namespace palpate {

class DeviceCheckQuery;
class HeldDevice;
struct DeviceCheckResult;
struct HelpEntry;
struct OpenedDevice;

/// State of the window, as the panels show it.
struct ViewStatus {
  const WindowSession* session = nullptr;  ///< null: no model is open
  static constexpr double kUnknown = -1;
  std::optional<double> loading;  ///< progress of loading or cleaning, 0 to 1, or kUnknown
  std::string loadingWhat;
  bool isStoppable = false;          ///< the loading
  std::vector<std::string> remarks;  ///< newest last; each is shown for a while
  std::vector<std::string> notices;  ///< each is shown as long as it is true
  std::string blocked;               ///< why nothing under the pressed brush moves; empty: it moves
  std::span<const std::string> errors;
  std::span<const std::string> models, recent;
  std::span<const std::string> gone;           ///< recent models that no longer exist
  std::string model;                           ///< the open model
  std::vector<NamedText> views;                ///< of it
  std::string saveFile;                        ///< target of Save
  std::string changesQuestion;                 ///< empty: no question
  bool isChanged = false, mayBeSaved = false;  ///< Document::isChanged(), mayBeSaved()
  std::optional<SaveQuestion> saveQuestion;
  std::optional<MemoryNeed> memoryQuestion;
  std::optional<LeftQuestion> leftQuestion;
  SelectionCounts selection;
  DrawnOutline outline;             ///< that selects
  DrawnVolume volume;               ///< that selects, or moves the selected points
  bool stylus = false;              ///< the mouse holds the stylus
  std::optional<double> pressed_N;  ///< force of the stylus of the mouse, while its button is down
  BrushHint brush;
  const HeldDevice* held = nullptr;  ///< the device that the user holds
  std::string gpu;
  struct ScaleBar {
    double width_px = 0, length = 0;  ///< length in file units
  };
  std::optional<ScaleBar> scaleBar;  ///< at the depth of the camera's target
  UpAxis upFound{};                  ///< from the model's shape
  std::string orientation;           ///< up and front in a few words, and how sure they are
  std::string orientationWhy;
  LengthUnit unit = LengthUnit::unknown;
  ViewSettings::ShownLength lengths;     ///< of the hand
  std::optional<DVec3> under;            ///< position of the model under the cursor, file coordinates
  double under_resolution = 0;           ///< of that (coordinateText())
  double picture_ms = 0;                 ///< time of a picture of the model
  std::optional<double> onTime_percent;  ///< ticks of the hand that were on time; empty: no hand is live
  std::optional<PlaceInfo> picked;       ///< the last picked position
  const Measure* measure = nullptr;      ///< never null while a frame is drawn
  std::vector<PictureLabel> labels;      ///< of the guides
  std::vector<PictureLabel> measures;    ///< of the measured distances
  std::optional<Legend> legend;          ///< set where points are coloured by height or by a field
  const ColoredField* field = nullptr;   ///< that field
  std::vector<std::string> fields;       ///< names of all
  std::string whereError;                ///< what is wrong with the condition of the last selection
  double meshTime_ms = 0;
  std::uint64_t meshTriangles = 0;
  const std::deque<float>* pictures_ms = nullptr;  ///< frame times
  double fps = 0;
  std::vector<PassRecord> passes;               ///< of the last picture of the model
  std::vector<SimulationParameter> parameters;  ///< of a simulated model
  bool simulationPaused = false;
  struct Others {
    std::optional<SharedCounts> counts;  ///< set where the model can be sculpted
    std::vector<SeenHand> hands;
    std::vector<SeenCamera> cameras;
  };
  std::optional<Others> others;  ///< other participants of the shared session
};

/// Text that says what happens to an existing file that is about to be written.
std::string whatIsReplaced(const std::filesystem::path& file, const ViewStatus& status);

class Panels {
 public:
  explicit Panels(Gui& gui) : gui_(gui) {}

  /// Text of the status line in the last frame; empty: it is not shown.
  const std::string& statusLine() const { return statusLine_; }
  Thumbnails& thumbnails() { return thumbnails_; }

  /// Called between Gui::begin() and Gui::end(). Changes the settings as the user sets them; returns other commands.
  ViewCommands draw(const ViewStatus& status, WindowSettings& settings);

  struct Tool {
    const char* name;
    std::string_view icon;
    std::string key, text;
    bool isOn;
    std::function<void()> choose;
  };
  /// The column of tools in the last frame.
  const std::vector<Tool>& tools() const { return tools_; }
  /// Part of the area of the model that messages and errors covered in the last frame.
  double messagesShare() const { return messagesShare_; }
  /// Controls whose label or text had no room in the last frame, by name; those that end in an ellipsis have the whole
  /// text in their tooltip, and are left out.
  const std::set<std::string>& cut() const { return cut_; }

  /// Position of the control of that name in the last frame, pixels; the last one if several have the name.
  std::optional<DVec2> placeOf(const std::string& name) const;
  /// Scrolls the control of that name into view in the next frames; empty: none.
  void scrollTo(const std::string& name);
  /// Opens the file dialogue with the next frame, in the folder of the model, or of its save file.
  void browse(FileTask task) { browses_ = task; }
  /// Closes the file dialogue.
  void closeFiles() { files_.reset(); }
  bool areFilesOpen() const { return files_.has_value(); }
  /// Minimum width of a window with room for the panel, the curves and a model between them, pixels.
  double roomyWidth_px() const { return double{em(56)}; }
  /// Whether the panel leaves room for a model in a window of that width.
  bool hasRoomBeside(double width_px) const;
  /// Left and right end of the range that no panel covers, in a window of that width, pixels from the left.
  DVec2 freeWidth_px(const ViewSettings& view, double width_px) const;

 private:
  // Each notes its position for placeOf().
  bool button(const char* name, float width = 0);
  bool checkbox(const char* name, bool& on);
  bool header(const char* name, bool open = false);
  bool dragLength(const char* name, double& value_mm, double speed_mm, const Range& range_mm, const ViewStatus& status,
                  const char* text = "");
  bool drag(const char* name, double& value, float speed, const Range& range, const char* format);
  template <class Names, class Value>
  bool choose(const char* name, const Names& names, Value& value) {
    std::vector<std::string_view> words;
    std::size_t chosen = names.size();
    for (const auto& [word, each] : names) {
      if (each == value) chosen = words.size();
      words.push_back(word);
    }
    if (!chooseWord(name, words, chosen)) return false;
    value = names.begin()[static_cast<std::ptrdiff_t>(chosen)].second;
    return true;
  }
  bool chooseWord(const char* name, std::span<const std::string_view> words, std::size_t& chosen);
  template <class Names, class Value>
  void chooseOrAuto(const char* name, const Names& names, std::optional<Value>& value, std::string_view now);
  // A list with that text; as ImGui::BeginCombo().
  bool beginList(const char* label, const char* shown);
  bool field(const char* hint, std::array<char, 512>& text, const char* name = nullptr);
  // A field that takes the room beside a button, which does what Enter does in it. Returns whether that is to be done.
  bool fieldAndButton(const char* hint, std::array<char, 512>& text, const char* does);
  float roomBeside(const char* button) const;
  // Sets the width of the next control, so that its label has room at its right; returns it.
  static float widthBesideLabel(const char* label);
  void noteText(std::string_view name, const char* text, float room);
  // The text, or its beginning with an ellipsis where it has no room: in one line, or in lines of the width `wrap`.
  std::string shortened(const std::string& text, float width) const;
  std::string shortenedLines(const std::string& text, float wrap, float height) const;
  static std::string shortenedTo(const std::string& text, const std::function<bool(const std::string&)>& fits);
  // Tooltip of the control drawn last, while it is pointed at: beside the panel, so that it does not cover the panel.
  void help(const std::string& text) const;
  void plot(const char* what, const std::vector<float>& curve, float least, float height,
            const std::string& span) const;
  bool noted(std::string_view name, bool result);
  // Posts the command if it is chosen; returns that.
  bool post(bool chosen, const ViewCommand& command);

  void noteLetters(const ViewStatus& status);
  void drawPanel(const ViewStatus& status, WindowSettings& settings);
  std::vector<Tool> toolsOf(const ViewStatus& status, WindowSettings& settings);
  void drawTools(const ViewStatus& status, WindowSettings& settings);
  void drawToolButton(const Tool& tool, const DVec2& size_px);
  void drawKey(const Tool& tool, const ImVec2& end) const;
  void drawStatusLine(const ViewStatus& status);
  // A button on the same line as the last one if it fits there.
  bool flowing(const char* name, bool isFirst);
  bool card(const char* name, float width, float picture, const std::function<void(const DVec2&, float)>& draw);
  void drawStart(const ViewStatus& status, ViewSettings& view);
  void drawLastFiles(const ViewStatus& status);
  void drawFirstSteps(ViewSettings& view);
  std::uint32_t ink(Tone tone) const { return inkOf(tone, gui_.isDark()); }
  void drawModel(const ViewStatus& status);
  void drawTool(const ViewStatus& status, WindowSettings& settings);
  void drawBrush(const ViewStatus& status, BrushSettings& brush, ViewSettings& view);
  void drawSelect(const ViewStatus& status, WindowSettings& settings);
  void drawSelected(const ViewStatus& status, SelectSettings& select);
  void drawLabel(SelectSettings& select);
  void drawWhere(const ViewStatus& status);
  void drawColor(const ViewStatus& status, WindowSettings& settings);
  void drawClean(const ViewStatus& status, CleanSettings& clean);
  void drawCleanNumber(const ViewStatus& status, CleanSettings& clean, std::string_view name, float indent);
  void drawField(const ColoredField& field, ColorConfig& color);
  void drawHistogram(const ColoredField& field, ColorConfig& color);
  void drawOutline(const DrawnOutline& outline);
  void drawBrushHint(const BrushHint& hint) const;
  void drawSymmetry(std::string& symmetry);
  void drawLayers(const ViewStatus& status);
  void drawLayer(const StrokeLayers& layers, std::uint32_t number);
  void drawVolume(const DrawnVolume& volume);
  void drawVolumeNumbers(const ViewStatus& status, SelectShape shape);
  void drawFeel(const ViewStatus& status, FeelSettings& feel, bool& forcesOn);
  void drawDevice(const ViewStatus& status);
  void drawDeviceFacts(const OpenedDevice& opened);
  void drawDeviceState(const HeldDevice& held);
  void drawDeviceTest(const DeviceCheckQuery& test);
  void drawDeviceFindings(const DeviceCheckResult& found, const OpenedDevice& opened);
  void drawDeviceSettings(const OpenedDevice& opened);
  void drawDeviceOffers(const HeldDevice& held);
  void drawOthers(const ViewStatus& status);
  void drawMatter(const ViewStatus& status);
  void drawLook(const ViewStatus& status, ViewSettings& view);
  void drawLight(LightConfig& light);
  void drawSides();
  void drawViews(const ViewStatus& status);
  void openFiles(FileTask task, const ViewStatus& status);
  void drawFiles(const ViewStatus& status);
  bool drawEntries();
  bool drawName();
  bool drawFilesButtons(const ViewStatus& status, bool chosen);
  void drawPlace(const PlaceInfo& info);
  void drawMeasure(const ViewStatus& status, ViewSettings& view);
  void drawDistances(const ViewStatus& status);
  void drawSession(const ViewStatus& status);
  void drawLink();
  void drawPlots(const ViewStatus& status, ViewSettings& view);
  void drawHelp(WindowSettings& settings);
  bool drawHelpEntry(const HelpEntry& entry, bool isFound);
  void carryOut(const HelpEntry& entry, WindowSettings& settings);
  void drawMessages(const ViewStatus& status, const WindowSettings& settings);
  void drawErrors(const ViewStatus& status);
  // Returns how many are shown.
  std::size_t drawTexts(std::span<const std::string> texts, float wrap, float area_px2, float below = 0);
  double modelArea_px2() const { return (free_px_.y - free_px_.x) * double{bottom_px_}; }
  // Of the area of the model: all messages, errors, and the others, which lie over the lower part of the model.
  static constexpr double kMaxCover = 1.0 / 3, kMaxErrors = 1.0 / 4, kMaxRemarks = 0.21;
  void drawScale(const ViewStatus::ScaleBar& bar, LengthUnit unit);
  void drawDistance(const PictureLabel& label) const;
  void drawLabels(const std::vector<PictureLabel>& labels) const;
  void drawLegend(const Legend& legend);
  struct AnswerButton {
    const char* name;
    Answer answer;
    bool isEscape = false;
  };
  static void underline(const char* name, std::size_t letter);
  bool letterButton(const char* name, char letter);
  void ask(const char* title, bool asks, const std::function<bool()>& draw);
  bool answers(std::initializer_list<AnswerButton> buttons);
  void drawQuestions(const ViewStatus& status);
  static constexpr double kTools_em = 3, kPanel_em = 16.5, kCurves_em = 18, kStatus_em = 1.6;
  static constexpr double kMargin_em = 0.6, kEdge_em = 0.3;
  static constexpr float kRounding_px = 0.5f;
  static constexpr double kMessages_em = 12;  ///< minimum width for messages beside the scale
  static constexpr double kModel_em = 6;      ///< minimum width for the model
  float em(double units) const { return static_cast<float>(units * 14 * gui_.scale()); }

  Gui& gui_;
  ViewCommands commands_;  // posted in this frame
  std::array<char, 512> open_{}, saveAs_{}, log_{}, trueLength_{}, axes_{}, colorRange_{}, where_{}, selectionName_{},
      volume_{}, way_{}, angles_{}, factor_{}, viewName_{}, distanceName_{}, layerName_{};
  std::array<char, 128> searched_{};
  std::size_t found_ = 0;    // entry of the help that Enter carries out
  std::string_view opens_;   // section that is opened in this frame, and all others are closed; empty: none
  std::string shownVolume_;  // numbers of the volume when they were last put into volume_
  DeviceState seenDevice_;
  bool paused_ = false;
  bool slides_ = false;     // the strength that is dragged has changed before, in the same drag
  bool dragsLow_ = false;   // the low end of the range of colours, in the histogram
  std::size_t chosen_ = 0;  // of the answers to a question: the one that Enter gives
  bool helps_ = true;       // tooltips are shown; off while the help window is open
  struct Files {
    FileTask task;
    FileBrowser browser;
    std::array<char, 512> name{}, folder{};
    std::string seen;  // chosen entry that the list has been scrolled to
  };
  std::optional<FileTask> browses_;
  std::optional<Files> files_;  // set while the file dialogue is open
  // Of this frame: ends of the range that no panel covers, top of the status line, and the upper left end of the scale
  // and the legend, which are at the lower right of that range.
  DVec2 free_px_{0}, corner_px_{0};
  float bottom_px_ = 0;
  double messagesShare_ = 0;
  std::string statusLine_;
  std::vector<Tool> tools_;  // of this frame
  std::string litTool_;      // the last one that was on in the last frame
  // Of the column of tools, where it scrolls: by how much next, and how far it is and may be scrolled.
  float scrollTools_ = 0;
  std::array<float, 2> toolsAt_{};
  Thumbnails thumbnails_;
  std::map<std::string, DVec2> places_;
  std::set<std::string> cut_;
  std::string scrollTo_;
  struct Curves {
    std::vector<float> force_N, penetration, step_us, picture_ms;
  } curves_;
  LinkHistory link_;
};

}  // namespace palpate

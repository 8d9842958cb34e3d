// What a person sees and turns in the window.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>

#include "apps/view/file_browser.hpp"
#include "apps/view/gui.hpp"
#include "apps/view/link_history.hpp"
#include "apps/view/place_info.hpp"
#include "apps/view/requests.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

/// What is going on, for the panels.
struct ViewStatus {
  const WindowSession* session = nullptr;  ///< null: none is open
  std::optional<double> loading;           ///< how far, 0 to 1
  std::string loadingWhat;
  std::vector<std::string> remarks;  ///< the newest last; each is shown for a while
  std::span<const std::string> errors;
  std::span<const std::string> models, recent;
  std::span<const std::string> gone;  ///< recent ones that are not there any more
  std::string model;                  ///< the one that is open
  std::string saveFile;               ///< where Save goes
  std::string changesQuestion;        ///< empty where nothing is asked
  std::optional<SaveQuestion> saveQuestion;
  std::optional<LeftQuestion> leftQuestion;
  bool stylus = false;  ///< the mouse holds it
  std::string device;   ///< that a person holds; empty for the mouse
  std::string gpu;
  struct ScaleBar {
    double width_px = 0, length = 0;  ///< of the file's units
  };
  std::optional<ScaleBar> scaleBar;  ///< at the depth of the camera's target
  Upright upright;                   ///< by the model's shape
  UpAxis up = UpAxis::y;             ///< as it is shown
  bool isUpTurned = false;           ///< from the shape's, by a person
  LengthUnit unit = LengthUnit::unknown;
  std::optional<PlaceInfo> picked;     ///< the last place that was
  std::optional<double> measured;      ///< between two places that were picked, units
  std::optional<DVec2> measuredAt_px;  ///< where the picture has the middle of them
  std::optional<HeightRange> heights;  ///< where colours are those of heights
  double meshTime_ms = 0;
  std::uint64_t meshTriangles = 0;
  const std::deque<float>* pictures_ms = nullptr;  ///< from picture to picture
  double fps = 0;
  std::vector<PassRecord> passes;               ///< of the last picture of the model
  std::vector<SimulationParameter> parameters;  ///< of what moves by itself
  bool simulationHeld = false;
  struct Others {
    std::optional<SharedCounts> counts;  ///< where the model is sculpted
    std::vector<SeenHand> hands;
    std::vector<SeenCamera> cameras;
  };
  std::optional<Others> others;  ///< who feels, sculpts and sees the model, too
};

/// What becomes of a file that is there already and is to be written, in words.
std::string whatIsReplaced(const std::filesystem::path& file, const ViewStatus& status);

class Panels {
 public:
  explicit Panels(Gui& gui) : gui_(gui) {}

  /// Between Gui::begin() and Gui::end(). Changes the settings as they are turned.
  ViewRequests draw(const ViewStatus& status, WindowSettings& settings);

  /// Where the last picture has what can be clicked, pixels; what is named so more than once, the last of them.
  std::optional<DVec2> placeOf(const std::string& name) const;
  /// In the pictures to come, brings what is named so into view where a panel is scrolled away from it. Empty: nothing.
  void scrollTo(const std::string& name);
  /// Looks for a file: beside the model, or where it is saved.
  void browse(FileTask task, const ViewStatus& status);
  /// No file is looked for any more.
  void closeFiles() { files_.reset(); }
  bool areFilesOpen() const { return files_.has_value(); }
  /// The least width of a window that has room for the panel, the curves and a model between them, pixels.
  double roomyWidth_px() const { return double{em(56)}; }
  /// Whether the panel leaves a model room in a window of that width.
  bool hasRoomBeside(double width_px) const;
  /// From where to where nothing is drawn over the model, from the left, in a window of that width, pixels.
  DVec2 freeWidth_px(const ViewSettings& view, double width_px) const;

 private:
  // Each notes where it is.
  bool button(const char* name, float width = 0);
  bool checkbox(const char* name, bool& on);
  bool header(const char* name, bool open = false);
  bool dragLength(const char* name, double& value_mm, double speed_mm, std::pair<double, double> range_mm,
                  const ViewStatus& status, const char* text = "");
  bool drag(const char* name, double& value, float speed, double least, double most, const char* format);
  template <class Names, class Value>
  bool choose(const char* name, const Names& names, Value& value);
  template <class Names, class Value>
  void chooseOrAuto(const char* name, const Names& names, std::optional<Value>& value, std::string_view now);
  bool field(const char* hint, std::array<char, 512>& text);
  // Of what was drawn last, while it is pointed at: beside the panel, where it covers nothing of that.
  void help(const std::string& text) const;
  void plot(const char* what, const std::vector<float>& curve, float least, float height,
            const std::string& span) const;
  bool noted(std::string_view name, bool result);

  void noteLetters(const ViewStatus& status);
  void drawPanel(const ViewStatus& status, WindowSettings& settings, ViewRequests& requests);
  void drawModel(const ViewStatus& status, ViewRequests& requests);
  void drawBrush(const ViewStatus& status, BrushSettings& brush, ViewSettings& view, ViewRequests& requests);
  void drawFeel(const ViewStatus& status, FeelSettings& feel, bool& forcesOn);
  void drawOthers(const ViewStatus& status);
  void drawMatter(const ViewStatus& status, ViewRequests& requests);
  void drawLook(const ViewStatus& status, ViewSettings& view, ViewRequests& requests);
  void drawSides(ViewRequests& requests);
  void drawFiles(const ViewStatus& status, ViewRequests& requests);
  bool drawEntries();
  bool drawName();
  bool drawFilesButtons(const ViewStatus& status, bool chosen, ViewRequests& requests);
  void drawPlace(const PlaceInfo& info);
  void drawMeasure(const ViewStatus& status, ViewSettings& view, ViewRequests& requests);
  void drawSession(const ViewStatus& status, ViewRequests& requests);
  void drawLink();
  void drawPlots(const ViewStatus& status, ViewSettings& view, ViewRequests& requests);
  void drawHelp(ViewSettings& view);
  void drawMessages(const ViewStatus& status, const ViewSettings& view);
  void drawErrors(const ViewStatus& status, const ViewSettings& view, ViewRequests& requests);
  void drawScale(const ViewStatus::ScaleBar& bar, LengthUnit unit) const;
  void drawDistance(const ViewStatus& status, const ViewSettings& view) const;
  void drawHeights(const HeightRange& heights, LengthUnit unit) const;
  void drawQuestion(const ViewStatus& status, ViewRequests& requests);
  void drawSaveQuestion(const ViewStatus& status, ViewRequests& requests);
  void drawLeftQuestion(const ViewStatus& status, ViewRequests& requests);
  static constexpr double kPanel_em = 18.5, kCurves_em = 18, kMargin_em = 0.6;
  static constexpr double kMessages_em = 32;  ///< the least width of what they stand in, beside the scale
  static constexpr double kModel_em = 6;      ///< the least width of what is left for it
  float em(double units) const { return static_cast<float>(units * 14 * gui_.scale()); }

  Gui& gui_;
  std::array<char, 512> open_{}, saveAs_{}, log_{}, trueLength_{};
  bool paused_ = false;
  bool helps_ = true;  // unless the whole of help is shown
  struct Files {
    FileTask task;
    FileBrowser browser;
    std::array<char, 512> name{}, folder{};
    std::string seen;  // of the list: chosen, and scrolled to
  };
  std::optional<Files> files_;  // while a file is looked for
  std::map<std::string, DVec2> places_;
  std::string scrollTo_;
  struct Curves {
    std::vector<float> force_N, penetration, step_us, picture_ms;
  } curves_;
  LinkHistory link_;
};

}  // namespace palpate

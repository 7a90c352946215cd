#include "apps/study/desk/words.hpp"

namespace apps {

const DeskWords& desk_words(const std::string& language) {
  static const DeskWords english{
      "Continue",
      "Confirm",
      "Rest your eyes",
      "Take a break",
      "Whenever you are ready",
      "1 question is still open",
      "%d questions are still open",
      "in %d s",
      "%d to %d",
      "may be left empty",
      "Press a number or click, then Enter",
      "Choose with the arrow keys and Enter, or click",
      "Tab leaves the field",
      "Stop the session?",
      "If you stop, the experimenter will come to you. What you have answered so far is kept.",
      "Do you want to stop?",
      "No, go on",
      "Yes, stop the session"};
  static const DeskWords german{"Weiter",
                                "Bestätigen",
                                "Ruhen Sie die Augen aus",
                                "Machen Sie eine Pause",
                                "Wenn Sie so weit sind",
                                "1 Frage ist noch offen",
                                "%d Fragen sind noch offen",
                                "in %d s",
                                "%d bis %d",
                                "darf leer bleiben",
                                "Drücken Sie eine Zahl oder klicken Sie, dann Eingabe",
                                "Wählen Sie mit den Pfeiltasten und Eingabe, oder klicken Sie",
                                "Tab verlässt das Feld",
                                "Sitzung abbrechen?",
                                "Wenn Sie abbrechen, kommt die Versuchsleitung zu Ihnen. Was Sie bisher "
                                "geantwortet haben, bleibt erhalten.",
                                "Möchten Sie abbrechen?",
                                "Nein, weiter",
                                "Ja, Sitzung abbrechen"};
  return language.starts_with("de") ? german : english;
}

}  // namespace apps

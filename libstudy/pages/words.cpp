#include "libstudy/pages/words.hpp"

namespace study {

namespace {

DeskWords english() {
  DeskWords words;
  words.go_on = "Continue";
  words.confirm = "Confirm";
  words.finish = "Finish";
  words.rest = "Rest your eyes";
  words.pause = "Take a break";
  words.ready = "Whenever you are ready";
  words.first = "First";
  words.second = "Second";
  words.held_title = "The session is paused";
  words.held = "Please wait. It goes on in a moment.";
  words.trouble_title = "A short pause";
  words.trouble =
      "The pictures cannot be shown at the moment. You did nothing wrong. Please tell the experimenter.";
  words.corner = "Esc: stop";
  words.begin = "You may stop at any time: press the key Esc.";
  words.corner_by_hand = "Stop";
  words.begin_by_hand =
      "You may stop at any time: hold the menu button for a second, or choose Stop on a page.";
  words.by_ray = "To answer, point at a button and press the trigger.";
  words.by_stick = "To answer, push the stick from button to button and press the trigger.";
  words.by_dwell = "To answer, look at a button until its ring is full.";
  words.one_open = "1 question is still open";
  words.many_open = "{} questions are still open";
  words.wait = "in {} s";
  words.range = "{} to {}";
  words.optional = "may be left empty";
  words.digits = "Press a number or click, then Enter";
  words.arrows = "Choose with the arrow keys and Enter, or click";
  words.tab = "Tab leaves the field";
  words.line = "Click on the line or use the arrow keys, then Enter";
  words.letters = "Press {} or {} or click, then Enter";
  words.react = "Press any key or button, as fast as you can";
  words.react_by_hand = "Press the trigger, as fast as you can";
  words.stop = {"Stop the session?",
                "If you stop, nothing more is shown. Then you say what becomes of your answers.",
                "Do you want to stop?", "No, go on", "Yes, stop the session"};
  words.over = {
      "The session is over",
      "Nothing more will be shown. Stopping is all right and has no disadvantage for you.\n\n"
      "Rest here until you feel as well as when you came, and tell the experimenter how you feel. Do "
      "not drive or ride before.",
      "I feel well"};
  words.refused = {"Thank you",
                   "You do not take part, and that is all right. Nothing is shown, and what you marked on "
                   "that page is not kept.\n\nPlease tell the experimenter.",
                   words.finish};
  words.not_eligible = {
      "Thank you for coming",
      "By what you answered, this study is not for you: its pictures could be bad for you, or "
      "it looks for others. Nothing is shown.\n\nPlease tell the experimenter.",
      words.finish};
  words.kept = {"Thank you",
                "What you gave is kept, under a code. You may still have it deleted later: tell the "
                "experimenter.\n\nStay until you feel well.",
                words.finish};
  words.deleted = {"Thank you",
                   "All that you gave is deleted when this page is closed.\n\nStay until you feel well.",
                   words.finish};
  words.goodbye = {"Thank you for coming", "Please tell the experimenter.", words.finish};
  words.stay_out = {"You do not take part?", "You did not consent on the page before.",
                    "Is that what you mean?", "No, back to that page", "Yes, I do not take part"};
  words.questionnaire = {"How do you feel?",
                         "A last page asks how you feel now. It helps to look after you. You may leave out "
                         "whatever you wish.",
                         "Would you answer it?", "Yes", "No"};
  words.keep = {"What you gave", "Your answers so far may stay in the study, under a code.",
                "What shall become of them?", "Keep them", "Delete all that I gave, for good"};
  return words;
}

DeskWords german() {
  DeskWords words;
  words.go_on = "Weiter";
  words.confirm = "Bestätigen";
  words.finish = "Beenden";
  words.rest = "Ruhen Sie die Augen aus";
  words.pause = "Machen Sie eine Pause";
  words.ready = "Wenn Sie so weit sind";
  words.first = "Erstes";
  words.second = "Zweites";
  words.held_title = "Die Sitzung ruht";
  words.held = "Bitte warten Sie. Es geht gleich weiter.";
  words.trouble_title = "Eine kurze Pause";
  words.trouble =
      "Die Bilder lassen sich gerade nicht zeigen. Sie haben nichts falsch gemacht. Bitte sagen Sie der "
      "Versuchsleitung Bescheid.";
  words.corner = "Esc: abbrechen";
  words.begin = "Sie können jederzeit abbrechen: drücken Sie die Taste Esc.";
  words.corner_by_hand = "Abbrechen";
  words.begin_by_hand =
      "Sie können jederzeit abbrechen: halten Sie die Menütaste eine Sekunde lang, oder wählen Sie Abbrechen "
      "auf einer Seite.";
  words.by_ray = "Zeigen Sie zum Antworten auf eine Schaltfläche und drücken Sie den Abzug.";
  words.by_stick =
      "Gehen Sie zum Antworten mit dem Stick von Schaltfläche zu Schaltfläche und drücken Sie den Abzug.";
  words.by_dwell = "Sehen Sie zum Antworten eine Schaltfläche an, bis ihr Ring voll ist.";
  words.one_open = "1 Frage ist noch offen";
  words.many_open = "{} Fragen sind noch offen";
  words.wait = "in {} s";
  words.range = "{} bis {}";
  words.optional = "darf leer bleiben";
  words.digits = "Drücken Sie eine Zahl oder klicken Sie, dann Eingabe";
  words.arrows = "Wählen Sie mit den Pfeiltasten und Eingabe, oder klicken Sie";
  words.tab = "Tab verlässt das Feld";
  words.line = "Klicken Sie auf die Linie oder nehmen Sie die Pfeiltasten, dann Eingabe";
  words.letters = "Drücken Sie {} oder {} oder klicken Sie, dann Eingabe";
  words.react = "Drücken Sie so schnell wie möglich irgendeine Taste";
  words.react_by_hand = "Drücken Sie so schnell wie möglich den Abzug";
  words.stop = {"Sitzung abbrechen?",
                "Wenn Sie abbrechen, wird nichts mehr gezeigt. Danach sagen Sie, was mit Ihren Antworten "
                "geschieht.",
                "Möchten Sie abbrechen?", "Nein, weiter", "Ja, Sitzung abbrechen"};
  words.over = {"Die Sitzung ist zu Ende",
                "Es wird nichts mehr gezeigt. Abzubrechen ist in Ordnung und hat keinen Nachteil für Sie.\n\n"
                "Ruhen Sie sich hier aus, bis es Ihnen so gut geht wie zu Beginn, und sagen Sie der "
                "Versuchsleitung, wie es Ihnen geht. Fahren Sie vorher nicht.",
                "Es geht mir gut"};
  words.refused = {
      "Danke",
      "Sie nehmen nicht teil, und das ist in Ordnung. Es wird nichts gezeigt, und was Sie auf der "
      "Seite angegeben haben, wird nicht aufbewahrt.\n\nBitte sagen Sie der Versuchsleitung "
      "Bescheid.",
      words.finish};
  words.not_eligible = {
      "Danke, dass Sie gekommen sind",
      "Nach Ihren Angaben ist diese Studie nichts für Sie: ihre Bilder könnten Ihnen schaden, "
      "oder sie sucht andere. Es wird nichts gezeigt.\n\nBitte sagen Sie der "
      "Versuchsleitung Bescheid.",
      words.finish};
  words.kept = {
      "Danke",
      "Was Sie angegeben haben, bleibt unter einem Code aufbewahrt. Sie können es auch später löschen "
      "lassen: sagen Sie es der Versuchsleitung.\n\nBleiben Sie, bis es Ihnen gut geht.",
      words.finish};
  words.deleted = {"Danke",
                   "Alles, was Sie angegeben haben, wird gelöscht, sobald diese Seite geschlossen ist.\n\n"
                   "Bleiben Sie, bis es Ihnen gut geht.",
                   words.finish};
  words.goodbye = {"Danke, dass Sie gekommen sind", "Bitte sagen Sie der Versuchsleitung Bescheid.",
                   words.finish};
  words.stay_out = {"Sie nehmen nicht teil?", "Sie haben auf der Seite davor nicht eingewilligt.",
                    "Ist das so gemeint?", "Nein, zurück zu der Seite", "Ja, ich nehme nicht teil"};
  words.questionnaire = {
      "Wie geht es Ihnen?",
      "Eine letzte Seite fragt, wie es Ihnen jetzt geht. Das hilft, für Sie zu sorgen. Sie "
      "dürfen alles auslassen.",
      "Möchten Sie sie beantworten?", "Ja", "Nein"};
  words.keep = {
      "Ihre Angaben", "Was Sie bisher geantwortet haben, kann unter einem Code in der Studie bleiben.",
      "Was soll damit geschehen?", "Aufbewahren", "Alles, was ich angegeben habe, endgültig löschen"};
  return words;
}

}  // namespace

const DeskPage& DeskWords::page(Notice notice) const {
  switch (notice) {
    case Notice::Over:
      return over;
    case Notice::Refused:
      return refused;
    case Notice::NotEligible:
      return not_eligible;
    case Notice::Kept:
      return kept;
    case Notice::Deleted:
      return deleted;
    case Notice::Goodbye:
      break;
  }
  return goodbye;
}

const DeskChoice& DeskWords::choice(Offer offer) const {
  if (offer == Offer::StayOut) return stay_out;
  return offer == Offer::Keep ? keep : questionnaire;
}

const DeskWords& desk_words(const std::string& language) {
  static const DeskWords in_english = english(), in_german = german();
  return language.starts_with("de") ? in_german : in_english;
}

}  // namespace study

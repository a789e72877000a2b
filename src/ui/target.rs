//! An entered value: the last valid one, and the text being typed.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::ui::entry::{Entry, Typed};

/// An entered value. Several fields can show it, each in its unit.
#[derive(Clone, Copy)]
pub(crate) struct Target(RwSignal<Entered>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Entered {
    /// The last valid value.
    value: i32,
    /// The text in one of the fields while the user types, valid or not.
    draft: Option<Draft>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Draft {
    /// The name of the field.
    field: &'static str,
    text: String,
    trouble: Option<String>,
}

impl Target {
    pub(crate) fn new(value: i32) -> Self {
        Self(RwSignal::new(Entered { value, draft: None }))
    }

    pub(crate) fn get(self) -> i32 {
        self.0.with(|entered| entered.value)
    }

    pub(crate) fn get_untracked(self) -> i32 {
        self.0.with_untracked(|entered| entered.value)
    }

    /// Sets the value from outside of the fields, and discards the text being typed.
    pub(crate) fn set(self, value: i32) {
        self.0.set(Entered { value, draft: None });
    }

    /// Takes the present text of a field. If it is not a value, the old value stays.
    pub(crate) fn type_in(self, field: &'static str, text: String, entry: Entry) {
        let typed = entry.read(&text);
        self.0.update(|entered| {
            let trouble = match typed {
                Typed::Value(value) => {
                    entered.value = value;
                    None
                }
                Typed::Unfinished => None,
                Typed::Wrong(words) => Some(words),
            };
            entered.draft = Some(Draft {
                field,
                text,
                trouble,
            });
        });
    }

    /// Handles the end of typing: the user has left the field or pressed Enter. A valid text is formatted, an invalid
    /// one stays with its error. Returns whether a value was entered.
    pub(crate) fn finish(self, field: &'static str, entry: Entry) -> bool {
        let mut good = false;
        self.0.update(|Entered { draft, .. }| {
            if let Some(typing) = draft.as_mut().filter(|draft| draft.field == field) {
                match entry.read(&typing.text) {
                    Typed::Value(_) => {
                        *draft = None;
                        good = true;
                    }
                    Typed::Unfinished => typing.trouble = Some(tr!("Enter a number.").to_owned()),
                    Typed::Wrong(words) => typing.trouble = Some(words),
                }
            }
        });
        good
    }

    /// The text of the field.
    pub(crate) fn text(self, field: &'static str, entry: Entry) -> String {
        self.0.with(|entered| {
            let mine = entered.draft.as_ref().filter(|draft| draft.field == field);
            mine.map_or_else(|| (entry.show)(entered.value), |draft| draft.text.clone())
        })
    }

    /// What is wrong with the text in this field.
    pub(crate) fn trouble_in(self, field: &'static str) -> Option<String> {
        self.0.with(|entered| {
            let mine = entered.draft.as_ref().filter(|draft| draft.field == field);
            mine.and_then(|draft| draft.trouble.clone())
        })
    }

    /// What is wrong with the text in any of its fields.
    pub(crate) fn trouble(self) -> Option<String> {
        self.0
            .with(|entered| entered.draft.as_ref()?.trouble.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::entry::{ANGLE, POSITION, SPEED};

    #[test]
    fn what_is_typed_stays_as_it_was_typed_until_it_is_finished() {
        let owner = Owner::new();
        owner.set();
        let speed = Target::new(100);
        assert_eq!(speed.text("Speed", SPEED), "+100");
        speed.type_in("Speed", "-".to_owned(), SPEED);
        assert_eq!(speed.get_untracked(), 100);
        speed.type_in("Speed", "-12".to_owned(), SPEED);
        assert_eq!(speed.text("Speed", SPEED), "-12");
        assert_eq!(speed.get_untracked(), -12);
        assert!(speed.finish("Speed", SPEED));
        assert_eq!(speed.text("Speed", SPEED), "\u{2212}12");
        assert!(!speed.finish("Speed", SPEED), "once");
    }

    #[test]
    fn a_value_out_of_range_is_kept_and_not_taken() {
        let owner = Owner::new();
        owner.set();
        let speed = Target::new(100);
        speed.type_in("Speed", "400".to_owned(), SPEED);
        assert!(!speed.finish("Speed", SPEED));
        assert_eq!(speed.text("Speed", SPEED), "400");
        assert!(speed.trouble_in("Speed").unwrap().contains("-380 to 380"));
        assert_eq!(speed.get_untracked(), 100);
        speed.set(50);
        assert_eq!(speed.text("Speed", SPEED), "+50");
        assert_eq!(speed.trouble(), None);
    }

    #[test]
    fn two_fields_show_one_value_in_their_units() {
        let owner = Owner::new();
        owner.set();
        let position = Target::new(0);
        position.type_in("Angle", "90".to_owned(), ANGLE);
        assert_eq!(position.text("Raw", POSITION), "8192");
        assert_eq!(position.text("Angle", ANGLE), "90");
        position.type_in("Raw", "99999".to_owned(), POSITION);
        assert_eq!(position.text("Angle", ANGLE), "90.0");
        assert_eq!(position.trouble_in("Angle"), None);
        assert!(position.trouble().is_some());
    }
}

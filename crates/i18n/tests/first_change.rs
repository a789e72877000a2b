//! The first change of CONTRIBUTING.md. The code between the marks is shown there, word for word.
#![cfg(test)]

// mark: function
use motorlink_i18n::terms::in_language;
use motorlink_messages::protocol::Rpm;

/// `0.60 s`: how long a wheel takes for one turn; nothing at a standstill.
pub(crate) fn turn_time(speed: Rpm) -> Option<String> {
    let rpm = speed.magnitude();
    (rpm != 0).then(|| in_language(format!("{:.2} s", 60.0 / f32::from(rpm))))
}
// mark: test
#[test]
fn a_turn_time_has_no_sign_and_no_value_at_a_standstill() {
    assert_eq!(turn_time(Rpm::new(100)).as_deref(), Some("0.60 s"));
    assert_eq!(turn_time(Rpm::new(-100)).as_deref(), Some("0.60 s"));
    assert_eq!(turn_time(Rpm::new(0)), None);
}
// mark: end

#[test]
fn contributing_shows_this_code() {
    let shown = include_str!("../../../CONTRIBUTING.md");
    let parts: Vec<&str> = include_str!("first_change.rs").split("// mark: ").collect();
    // The first is the comment at the top, and the last is this test.
    for name in ["function\n", "test\n"] {
        let part = parts.iter().find_map(|part| part.strip_prefix(name));
        let code = part.unwrap().trim();
        assert!(
            shown.contains(&format!("```rust\n{code}\n```")),
            "not in CONTRIBUTING.md:\n{code}"
        );
    }
}

#[test]
fn contributing_shows_a_message_of_the_translations() {
    let shown = include_str!("../../../CONTRIBUTING.md");
    let (_, rest) = shown.split_once("```po\n").unwrap();
    let (message, _) = rest.split_once("\n```").unwrap();
    assert!(include_str!("../../../locales/de.po").contains(message));
}

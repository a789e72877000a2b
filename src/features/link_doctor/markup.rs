//! The panel as HTML.

use motorlink_diagnosis::{
    Verdict,
    texts::{cause, loss_ended, remedy, some_lost, too_little, well},
};
use motorlink_i18n::tr;
use motorlink_messages::LineCondition;

use crate::features::link_doctor::texts::{self, no_virtual_wire, of_diagnosis};

/// Where the figures stand, in the order of [`super::figures::of`].
pub(crate) const FIGURES: [&str; 7] = [
    ".link-exchanges",
    ".link-bus-time",
    ".link-round-trip",
    ".link-histogram",
    "table",
    ".link-carries",
    ".link-drawing",
];

/// The panel without what changes in it. A fault to practise on stands beside what it does to the diagnosis.
pub(crate) fn panel() -> String {
    let mut html = String::new();
    push(
        &mut html,
        &[
            r#"<ul class="link-doctor" aria-label=""#,
            tr!("Link diagnosis"),
            r#"" aria-live="polite"></ul><output class="quiet link-judged" aria-live="off" aria-label=""#,
            tr!("Based on"),
            r#""></output><label class="link-wire"><span class="label">"#,
            tr!("Simulated fault"),
            r#"</span><select class="select" aria-label=""#,
            tr!("Simulated fault"),
            r#"" disabled title=""#,
            no_virtual_wire(),
            "\">",
        ],
    );
    // The value of each is its place.
    for (place, wire) in LineCondition::ALL.iter().enumerate() {
        let (place, name) = (place.to_string(), texts::wire(*wire));
        push(
            &mut html,
            &["<option value=\"", &place, "\">", name, "</option>"],
        );
    }
    push(
        &mut html,
        &[
            "</select></label><p class=\"quiet\">",
            tr!(
                "Two motors with one ID: the page stops the motor first, because both obey its frames."
            ),
            "</p><p class=\"quiet\">",
            tr!("Simulated CRC errors rise with speed: drive the motor to see them."),
            r#"</p><output class="link-carries" aria-label=""#,
            tr!("Bus capacity"),
            r#""></output><div class="link-figures">"#,
        ],
    );
    for (class, name) in [
        ("link-exchanges", tr!("Exchanges")),
        ("link-bus-time", tr!("Bus load")),
        ("link-round-trip", tr!("Round trip")),
        ("link-drawing", tr!("Drawing")),
    ] {
        push(
            &mut html,
            &[
                r#"<span class="label">"#,
                name,
                r#"</span><output class=""#,
                class,
                r#"" aria-label=""#,
                name,
                r#"" aria-live="off"></output>"#,
            ],
        );
    }
    push(
        &mut html,
        &[
            r#"</div><div class="link-histogram" role="img" aria-label=""#,
            tr!("Round trip histogram"),
            r#"" title=""#,
            tr!("Round trips of the last 256 exchanges, in ms"),
            r#""></div><table class="link-motors" aria-label=""#,
            tr!("Motors on the bus"),
            r#""></table>"#,
        ],
    );
    html
}

/// The result of a diagnosis.
pub(crate) fn verdict(verdict: &Verdict) -> String {
    let mut html = String::new();
    let (class, text) = match verdict {
        Verdict::NotConnected => ("", texts::not_connected()),
        Verdict::TooLittle => ("", too_little()),
        Verdict::Healthy => ("good", well()),
        Verdict::SomeLoss => ("", some_lost()),
        Verdict::LossEnded => ("", loss_ended()),
        Verdict::Faulty(found) => {
            let advice = texts::advice();
            for diagnosis in found {
                let cause = cause(*diagnosis);
                push(&mut html, &["<li class=\"ill\"><b>", &cause, "</b>"]);
                for line in remedy(*diagnosis, &advice) {
                    push(&mut html, &["<p>", line, "</p>"]);
                }
                let topic = of_diagnosis(*diagnosis);
                let (id, link) = (topic.id(), topic.link());
                let button = "<button type=\"button\" class=\"help-link\" data-help=\"";
                push(&mut html, &[button, id, "\">", &link, "</button></li>"]);
            }
            return html;
        }
    };
    push(&mut html, &["<li class=\"", class, "\">", text, "</li>"]);
    html
}

/// Out of line: in each of its callers it would weigh as much as here.
#[inline(never)]
pub(crate) fn push(html: &mut String, parts: &[&str]) {
    for part in parts {
        html.push_str(part);
    }
}

#[cfg(test)]
mod tests {
    use motorlink_diagnosis::Diagnosis;
    use motorlink_messages::protocol::MotorId;

    use super::*;

    #[test]
    fn every_diagnosis_has_a_cause_and_a_remedy() {
        let id = MotorId::FIRST;
        for diagnosis in [
            Diagnosis::Blocks,
            Diagnosis::Floating,
            Diagnosis::Turnaround,
            Diagnosis::Nothing,
            Diagnosis::EchoOnly,
            Diagnosis::SharedId(id),
            Diagnosis::NoiseGrowsWithSpeed,
            Diagnosis::Damaged,
            Diagnosis::Lost,
            Diagnosis::Stranger,
            Diagnosis::Silent(id),
            Diagnosis::LatencyTimer,
        ] {
            let html = verdict(&Verdict::Faulty(vec![diagnosis]));
            assert_eq!(html.matches("<li").count(), 1);
            assert!(html.contains("<p>"), "{html}");
            assert!(html.contains("Help: "), "{html}");
            // The texts go into the page as HTML.
            let (text, _link) = html.split_once("<button").unwrap();
            let text = text.replace("<li class=\"ill\">", "");
            assert!(!text.contains('&') && !text.contains('"'), "{html}");
        }
    }

    #[test]
    fn what_is_most_likely_is_told_first() {
        let html = verdict(&Verdict::Faulty(vec![
            Diagnosis::Damaged,
            Diagnosis::LatencyTimer,
        ]));
        assert!(html.find("corrupted") < html.find("16 ms"));
        assert_eq!(html.matches("<li").count(), 2);
        assert!(verdict(&Verdict::Healthy).contains("Bus healthy"));
    }

    #[test]
    fn every_wire_can_be_chosen_and_every_figure_has_its_place() {
        let html = panel();
        assert_eq!(html.matches("<option").count(), LineCondition::ALL.len());
        assert!(html.contains("<option value=\"2\">Echo only</option>"));
        for selector in FIGURES {
            let place = match selector.strip_prefix('.') {
                Some(class) => format!("class=\"{class}\""),
                None => format!("<{selector} "),
            };
            assert!(html.contains(&place), "{selector}");
        }
    }
}

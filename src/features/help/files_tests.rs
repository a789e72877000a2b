//! The help's files, held against what leads to them.

use motorlink_i18n::{Language, family_terms, set_language};
use motorlink_messages::protocol::{Frame, Layout, Mode, Reply, Request, family::Model};
use strum::VariantArray;

use crate::{features::help::line_card, model::help_topic::HelpTopic};

const FILES: [(&str, &str); 3] = [
    ("en", include_str!("../../../public/help/en.html")),
    ("zh", include_str!("../../../public/help/zh.html")),
    ("de", include_str!("../../../public/help/de.html")),
];

const DRAWING: &str = include_str!("../../../public/help/wiring.svg");

/// What stands behind each `before`, up to the next `"`.
fn all<'a>(text: &'a str, before: &'a str) -> impl Iterator<Item = &'a str> {
    let rest = text.split(before).skip(1);
    rest.map(|rest| rest.split('"').next().unwrap())
}

#[test]
fn every_topic_stands_in_every_language_in_one_order() {
    let topics: Vec<&str> = HelpTopic::VARIANTS.iter().map(|topic| topic.id()).collect();
    for (language, html) in FILES {
        let ids: Vec<&str> = all(html, " id=\"").collect();
        assert_eq!(ids, topics, "{language}");
    }
    for topic in HelpTopic::VARIANTS {
        assert_eq!(HelpTopic::from_id(topic.id()), Some(*topic));
    }
}

#[test]
fn every_link_in_the_help_leads_to_a_topic() {
    for (language, html) in FILES {
        let links: Vec<&str> = all(html, "href=\"#").collect();
        assert!(links.len() > 10, "{language}");
        for link in links {
            assert!(HelpTopic::from_id(link).is_some(), "{language}: {link}");
        }
        assert_eq!(html.matches("href=").count(), all(html, "href=\"#").count());
    }
}

#[test]
fn every_language_says_as_much() {
    let parts = [
        "<h3",
        "<h4",
        "<pre",
        "<tr",
        "<li",
        "<kbd",
        "data-copy=",
        "data-for=",
        "data-live=",
        "data-says=",
    ];
    let (_, english) = FILES[0];
    for (language, html) in FILES {
        for part in parts {
            let count = html.matches(part).count();
            assert_eq!(count, english.matches(part).count(), "{language}: {part}");
        }
        assert_eq!(html.matches("<!-- wiring.svg -->").count(), 1, "{language}");
        let commands = |text| -> Vec<&str> {
            let codes = str::split(text, "<pre><code>").skip(1);
            codes
                .map(|rest| rest.split("</code>").next().unwrap())
                .collect()
        };
        assert_eq!(commands(html), commands(english), "{language}");
    }
}

/// Wiring, pinout, specifications, protocol and faults are there for each model once; nothing is for a model that does
/// not exist.
#[test]
fn each_model_has_its_own_words_in_every_language() {
    let keys = Model::ALL.map(|model| model.spec().key);
    for (language, html) in FILES {
        for of_these in all(html, "data-for=\"") {
            assert!(
                of_these.split(' ').all(|key| keys.contains(&key)),
                "{language}: {of_these}"
            );
        }
        for topic in ["wiring", "pinout", "specifications", "protocol", "faults"] {
            let (_, section) = html.split_once(&format!("<h3 id=\"{topic}\"")).unwrap();
            let section = section.split("<h3").next().unwrap();
            // An example of a frame stands in a text that is for more than its model.
            let section = &section.replace("class=\"frame\" data-for=", "");
            for key in keys {
                let of_model = all(section, "data-for=\"");
                let count = of_model.filter(|keys| keys.split(' ').any(|one| one == key));
                // The drawing of a DDSM115 has a remark for the DDSM315.
                let expected = 1 + usize::from(topic == "wiring" && key == "ddsm315");
                assert_eq!(count.count(), expected, "{language}: {topic} {key}");
            }
        }
        for model in Model::ALL {
            let spec = model.spec();
            assert!(html.contains(spec.maker_name), "{language}: {model}");
            let ends = ["rpm; ", "rpm；", "U/min; "];
            let mut reaches = ends
                .map(|end| format!("{} {end}", spec.speed_rpm_max))
                .into_iter();
            assert!(
                reaches.any(|reach| html.contains(&reach)),
                "{language}: {model}"
            );
        }
    }
}

/// The examples of separate frames are explained as in the packet log, each for its model.
#[test]
fn the_examples_of_separate_frames_are_explained_as_elsewhere() {
    for ((name, html), language) in FILES.into_iter().zip(Language::ALL) {
        set_language(language);
        let (_, protocol) = html.split_once("<h3 id=\"protocol\"").unwrap();
        let (_, separate) = protocol.split_once("data-for=\"ddsm210 ddsm400\"").unwrap();
        let (separate, _) = separate.split_once("</div>").unwrap();
        let examples: Vec<&str> = separate.split("<p class=\"frame\"").skip(1).collect();
        assert_eq!(examples.len(), 11, "{name}");
        for example in examples {
            let (attributes, rest) = example.split_once('>').unwrap();
            let (_, rest) = rest.split_once("<code>").unwrap();
            let (frame, words) = rest.split_once("</code> ").unwrap();
            let (words, _) = words.split_once('<').unwrap();
            let frame: Frame = frame.parse().unwrap();
            let of_400 = attributes.contains("ddsm400");
            let model = if of_400 {
                Model::Ddsm400
            } else {
                Model::Ddsm210
            };
            // A reply of a DDSM210 may look like a request: only replies name one model, and the frame that enables.
            let is_sent = attributes.is_empty() || frame.bytes()[1] == 0xA0;
            let explained = if is_sent {
                family_terms::sent(model, &frame, Some(Mode::Velocity))
            } else {
                family_terms::received(model, &frame, None)
            };
            assert_eq!(words, explained, "{name} {frame}");
        }
    }
    set_language(Language::English);
}

/// What the page's policy forbids, or would not pass on.
#[test]
fn nothing_in_the_help_needs_a_right() {
    for html in FILES.map(|(_, html)| html).into_iter().chain([DRAWING]) {
        for forbidden in [
            "style=", "<script", "<link", "<form", "<style", " on", "http",
        ] {
            let tags = html.split('<').filter_map(|tag| tag.split_once('>'));
            for (tag, _) in tags {
                assert!(!format!("<{tag}").contains(forbidden), "{forbidden}: {tag}");
            }
        }
    }
}

/// The examples are frames as real ones are, each of the kind that it stands for.
#[test]
fn the_examples_are_frames() {
    for (language, html) in FILES {
        for kind in line_card::KINDS {
            let (_, rest) = html.split_once(&format!("data-live=\"{kind}\">")).unwrap();
            let text = rest.split('<').next().unwrap();
            let frame: Frame = text.parse().unwrap();
            let reply = |layout| Reply::decode(&frame, Some(layout)).unwrap().frame() == frame;
            let is_one = match (kind, Request::parse(&frame)) {
                ("drive", Ok(Request::Drive { .. }))
                | ("query", Ok(Request::Query { .. }))
                | ("mode", Ok(Request::SwitchMode { .. })) => true,
                ("drive-reply", _) => reply(Layout::Drive),
                ("query-reply", _) => reply(Layout::Query),
                _ => false,
            };
            assert!(is_one, "{language}: {kind} {text}");
        }
    }
}

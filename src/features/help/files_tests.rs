//! The help's files, held against what leads to them.

use motorlink_messages::protocol::{Frame, Layout, Reply, Request};

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
    let topics = HelpTopic::ALL.map(HelpTopic::id);
    for (language, html) in FILES {
        let ids: Vec<&str> = all(html, " id=\"").collect();
        assert_eq!(ids, topics, "{language}");
    }
    for topic in HelpTopic::ALL {
        assert_eq!(HelpTopic::from_id(topic.id()), Some(topic));
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

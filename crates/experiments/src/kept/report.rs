//! Runs as one self-contained HTML file.

use motorlink_markup::Element;

use crate::chart::{Chart, HEIGHT_MAX, Names, STYLE as CHART_STYLE, WIDTH};

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;\
color:#14181e;background:#fff}table{border-collapse:collapse;margin:.5rem 0 1.5rem}th,td{text-align:left;\
padding:.2rem .8rem .2rem 0;border-bottom:1px solid #e2e6eb;vertical-align:top;font-variant-numeric:tabular-nums}\
svg{width:100%;height:auto}";

/// A run of the report: texts in the language of the reader.
#[derive(Clone, Debug)]
pub struct ReportRun {
    /// Its name.
    pub name: String,
    /// Facts and figures with their names, in order.
    pub rows: Vec<(String, String)>,
    /// What the figures mean.
    pub meaning: Vec<String>,
}

/// The texts around the runs.
#[derive(Clone, Debug)]
pub struct ReportTexts {
    /// The language, such as `en`.
    pub language: &'static str,
    /// The title.
    pub title: String,
}

/// The report.
#[must_use]
pub fn report(
    texts: &ReportTexts,
    runs: &[ReportRun],
    charts: &[Chart],
    names: &Names<'_>,
) -> String {
    let head = Element::new("head")
        .child(Element::new("meta").with("charset", "utf-8"))
        .child(Element::new("title").text(texts.title.clone()))
        .child(Element::new("style").text(format!("{STYLE}{CHART_STYLE}")));
    let run = |run: &ReportRun| {
        let row = |(name, value): &(String, String)| {
            let name = Element::new("th").with("scope", "row").text(name.clone());
            let value = Element::new("td").text(value.clone());
            Element::new("tr").child(name).child(value)
        };
        let meaning = run.meaning.iter();
        Element::new("section")
            .child(Element::new("h2").text(run.name.clone()))
            .child(Element::new("table").children(run.rows.iter().map(row)))
            .children(meaning.map(|text| Element::new("p").text(text.clone())))
    };
    let body = Element::new("body")
        .child(Element::new("h1").text(texts.title.clone()))
        .children(
            charts
                .iter()
                .map(|chart| chart.svg(names, WIDTH, HEIGHT_MAX)),
        )
        .children(runs.iter().map(run));
    let page = Element::new("html")
        .with("lang", texts.language)
        .child(head)
        .child(body);
    let mut out = "<!DOCTYPE html>\n".to_owned();
    page.write(&mut out);
    out.push('\n');
    out
}

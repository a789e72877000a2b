//! Files of runs: tables, whole runs, pictures and a report.

use js_sys::Array;
use leptos::prelude::*;
use motorlink_i18n::{current_language, tr};
use motorlink_messages::experiments::{
    chart::{Chart, file},
    kept::{
        ReportRun, ReportTexts, figures_to_csv, figures_to_json, record_to_csv, report, run_to_json,
    },
};
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{
    Blob, BlobPropertyBag, CanvasRenderingContext2d, HtmlCanvasElement, HtmlImageElement, Url,
};

use super::{
    texts,
    view::{charts_of, figures_of, rates},
};
use crate::{
    features::experiments::{kept::KeptRuns, texts as study_texts},
    ui::{clock::local_date, download::save_blob},
};

/// Pixels of a picture for each unit of the chart.
const SCALE: u32 = 2;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Csv,
    Json,
    Png,
    Report,
    FiguresCsv,
    FiguresJson,
}

impl Format {
    pub(super) const ALL: [Self; 6] = [
        Self::Report,
        Self::Csv,
        Self::Json,
        Self::FiguresCsv,
        Self::FiguresJson,
        Self::Png,
    ];

    pub(super) const fn key(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Json => "json",
            Self::Png => "png",
            Self::Report => "html",
            Self::FiguresCsv => "figures.csv",
            Self::FiguresJson => "figures.json",
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Csv => tr!("Data (CSV)"),
            Self::Json => tr!("Whole run (JSON)"),
            Self::Png => tr!("Chart (PNG)"),
            Self::Report => tr!("Report (HTML)"),
            Self::FiguresCsv => tr!("Figures (CSV)"),
            Self::FiguresJson => tr!("Figures (JSON)"),
        }
    }
}

fn figures(kept: KeptRuns, number: u32, format: Format) -> Option<String> {
    let header = kept.header(number)?;
    let (study, findings) = (header.study()?, kept.findings(number)?);
    Some(match format {
        Format::FiguresCsv => figures_to_csv(&header, &study, &findings),
        _ => figures_to_json(&header, &study, &findings),
    })
}

/// Saves these runs. CSV and JSON are a file for each run.
pub(super) fn export(kept: KeptRuns, runs: &[u32], format: Format) {
    let end = format.key();
    match format {
        Format::Csv | Format::Json => {
            for number in runs {
                let Some(header) = kept.header(*number) else {
                    continue;
                };
                let text = kept.with_record(*number, |record| match format {
                    Format::Csv => record_to_csv(record),
                    _ => run_to_json(&header, record),
                });
                if let Some(text) = text {
                    save_text(&text, &file_name(kept, *number, end));
                }
            }
        }
        Format::FiguresCsv | Format::FiguresJson => {
            for number in runs {
                if let Some(text) = figures(kept, *number, format) {
                    save_text(&text, &file_name(kept, *number, end));
                }
            }
        }
        Format::Report => {
            let texts = ReportTexts {
                language: current_language().tag(),
                title: tr!("Experiments").to_owned(),
            };
            let sections: Vec<ReportRun> = runs
                .iter()
                .filter_map(|number| section(kept, *number))
                .collect();
            let charts = charts_of(kept, runs);
            let html = report(&texts, &sections, &charts, &study_texts::axis);
            save_text(
                &html,
                &format!("motorlink-report-{}.html", date(kept, runs)),
            );
        }
        Format::Png => save_picture(&charts_of(kept, runs)),
    }
}

/// `motorlink-run-3-2026-11-29.csv`: the number and the date of the run.
fn file_name(kept: KeptRuns, number: u32, end: &str) -> String {
    format!("motorlink-run-{number}-{}.{end}", date(kept, &[number]))
}

/// The date of the first of these runs.
fn date(kept: KeptRuns, runs: &[u32]) -> String {
    let first = runs.iter().find_map(|number| kept.header(*number));
    first
        .map(|run| local_date(run.began_unix_ms))
        .unwrap_or_default()
}

fn section(kept: KeptRuns, number: u32) -> Option<ReportRun> {
    let header = kept.header(number)?;
    let mut study = header.study()?;
    let kind = study.kind();
    let mut rows = vec![
        (tr!("Study").to_owned(), study_texts::study(kind).to_owned()),
        (tr!("Motor").to_owned(), texts::motors(&header)),
        (tr!("Model").to_owned(), header.model.clone()),
        (tr!("Date").to_owned(), texts::date(&header)),
        (tr!("End").to_owned(), texts::end(kept, &header)),
        (
            tr!("Limits").to_owned(),
            study_texts::limits(header.limits()),
        ),
    ];
    let rates = rates(kept, &header);
    let rates = rates.and_then(|rates| texts::setpoint_rate(&header, &rates));
    rows.extend(rates);
    rows.extend(texts::accelerations(&study).map(|list| (tr!("Accelerations").to_owned(), list)));
    rows.extend(study.parameters().iter().map(|parameter| {
        let (name, unit) = study_texts::parameter(parameter.name);
        let value = study_texts::number(parameter.value());
        (name.to_owned(), format!("{value} {unit}"))
    }));
    let figures = figures_of(kept, &header).unwrap_or_default();
    if figures.columns.len() > 1 {
        rows.push((String::new(), figures.columns.join(" | ")));
    }
    let values = figures.rows.into_iter();
    rows.extend(values.map(|row| (row.name.to_owned(), row.values.join(" | "))));
    Some(ReportRun {
        name: header.name,
        rows,
        meaning: figures.meaning.into_iter().chain(figures.maker).collect(),
    })
}

pub(in crate::features::experiments) fn save_text(text: &str, name: &str) {
    if let Ok(blob) = Blob::new_with_str_sequence(&Array::of1(&text.into())) {
        save_blob(&blob, name);
    }
}

/// The charts as PNG: the browser draws the SVG file, at twice its size.
fn save_picture(charts: &[Chart]) {
    let options = BlobPropertyBag::new();
    options.set_type("image/svg+xml");
    let text = Array::of1(&file(charts, &study_texts::axis).into());
    let Ok(blob) = Blob::new_with_str_sequence_and_options(&text, &options) else {
        return;
    };
    let (Ok(url), Ok(image)) = (
        Url::create_object_url_with_blob(&blob),
        HtmlImageElement::new(),
    ) else {
        return;
    };
    let drawn = image.clone();
    let address = url.clone();
    let draw = Closure::once_into_js(move || {
        // It fails for expired addresses only.
        let _ = Url::revoke_object_url(&address);
        // Without memory for a canvas there is no picture.
        let _ = save_drawn(&drawn);
    });
    image.set_onload(Some(draw.unchecked_ref()));
    image.set_src(&url);
}

fn save_drawn(image: &HtmlImageElement) -> Option<()> {
    let canvas = document().create_element("canvas").ok()?;
    let canvas: HtmlCanvasElement = canvas.dyn_into().ok()?;
    canvas.set_width(image.natural_width() * SCALE);
    canvas.set_height(image.natural_height() * SCALE);
    let context = canvas.get_context("2d").ok()??;
    let context: CanvasRenderingContext2d = context.dyn_into().ok()?;
    let (width, height) = (f64::from(canvas.width()), f64::from(canvas.height()));
    context
        .draw_image_with_html_image_element_and_dw_and_dh(image, 0.0, 0.0, width, height)
        .ok()?;
    let save = Closure::once_into_js(|blob: Blob| save_blob(&blob, "motorlink-chart.png"));
    canvas.to_blob(save.unchecked_ref()).ok()
}

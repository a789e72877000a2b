//! The graph as a file: an image, or a drawing.

use js_sys::{Function, Promise};
use motorlink_messages::protocol::Rpm;
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Blob, Document, Element, Event, HtmlCanvasElement, ImageBitmap, Response};

use super::{bench, canvas, colour_of, context, is_drawn, pixels, report, rows_of, steady};
use crate::bench::{Bench, document};

/// The name and the content of the file that the browser is made to save.
async fn saved(press: impl FnOnce()) -> (String, Blob) {
    // The link that the page presses is not followed: a test saves no files.
    let pressed = Promise::new(&mut |resolve, _| {
        let heard = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
            let link: Element = event.target().unwrap().unchecked_into();
            if link.has_attribute("download") {
                event.prevent_default();
                resolve.call1(&JsValue::NULL, &link).unwrap();
            }
        });
        let heard = heard.into_js_value();
        document()
            .add_event_listener_with_callback("click", heard.unchecked_ref())
            .unwrap();
    });
    press();
    let link: Element = JsFuture::from(pressed).await.unwrap().unchecked_into();
    let file = link.get_attribute("download").unwrap();
    let window = web_sys::window().unwrap();
    let fetched = window.fetch_with_str(&link.get_attribute("href").unwrap());
    let response: Response = JsFuture::from(fetched).await.unwrap().unchecked_into();
    let blob = JsFuture::from(response.blob().unwrap()).await.unwrap();
    (file, blob.unchecked_into())
}

#[wasm_bindgen_test]
async fn the_picture_is_a_png_with_a_background() {
    let bench = bench("graph-png").await;
    report(&bench, steady(9_000, 100));
    let canvas = canvas(&bench);
    bench.until("a line", || is_drawn(&canvas)).await;

    let (file, blob) = saved(|| bench.click("PNG")).await;
    let time = file.strip_prefix("motorlink-graph-20");
    let time = time.and_then(|rest| rest.strip_suffix(".png"));
    assert_eq!(time.map(str::len), Some(13), "{file}");
    assert_eq!(blob.type_(), "image/png");
    let window = web_sys::window().unwrap();
    let bitmap = window.create_image_bitmap_with_blob(&blob).unwrap();
    let bitmap: ImageBitmap = JsFuture::from(bitmap).await.unwrap().unchecked_into();
    assert!(bitmap.width() >= 1_600 && bitmap.height() > 900);
    assert!(canvas.width() < 1_600, "the graph has its size again");

    let copy: HtmlCanvasElement = document()
        .create_element("canvas")
        .unwrap()
        .unchecked_into();
    copy.set_width(bitmap.width());
    copy.set_height(bitmap.height());
    context(&copy)
        .draw_image_with_image_bitmap(&bitmap, 0.0, 0.0)
        .unwrap();
    assert!(pixels(&copy).iter().all(|[.., opacity]| *opacity == 255));
    let speed = colour_of(&bench, "--speed");
    assert!(!rows_of(&copy, speed, 20).is_empty(), "the line");
    assert_eq!(pixels(&copy)[0][..3], colour_of(&bench, "--surface"));
}

/// The content of the file that the button saves, parsed by the browser's parser of XML.
async fn saved_drawing(bench: &Bench) -> Document {
    let (file, blob) = saved(|| bench.click("Save SVG")).await;
    assert!(
        file.starts_with("motorlink-graph-20")
            && file.split_once('.').is_some_and(|(_, kind)| kind == "svg"),
        "{file}"
    );
    let text = JsFuture::from(blob.text()).await.unwrap();
    let parse = Function::new_with_args(
        "text",
        "return new DOMParser().parseFromString(text, 'image/svg+xml')",
    );
    let drawing: Document = parse.call1(&JsValue::NULL, &text).unwrap().unchecked_into();
    let error = drawing.query_selector("parsererror").unwrap();
    assert!(error.is_none(), "{:?}", text.as_string());
    drawing
}

fn texts(drawing: &Document) -> Vec<String> {
    let all = drawing.query_selector_all("text").unwrap();
    let text = |place| all.get(place)?.text_content();
    (0..all.length()).filter_map(text).collect()
}

/// The paths of this colour as points, in pixels of the drawing.
fn paths(drawing: &Document, colour: &str) -> Vec<Vec<(f64, f64)>> {
    let all =
        drawing.query_selector_all(&format!("path[stroke='{colour}']:not([stroke-dasharray])"));
    let all = all.unwrap();
    let points = |place| {
        let path: Element = all.get(place)?.unchecked_into();
        let data = path.get_attribute("d")?;
        let point = |point: &str| {
            let (x, y) = point.split_once(' ').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        };
        Some(data[1..].split('L').map(point).collect())
    };
    (0..all.length()).filter_map(points).collect()
}

#[wasm_bindgen_test]
async fn the_drawing_is_xml_with_axes_lines_and_escaped_names() {
    let storage = web_sys::window().unwrap().local_storage().unwrap().unwrap();
    let name = "<b>\"A\" & 'B'";
    storage
        .set_item("motorlink.fleet", &format!("1\tno\tnone\t{name}\n"))
        .unwrap();
    let bench = bench("graph-svg").await;
    report(&bench, steady(5_000, 100));
    let canvas = canvas(&bench);
    bench.until("a line", || is_drawn(&canvas)).await;
    let (width, height) = (canvas.width(), canvas.height());
    let drawing = saved_drawing(&bench).await;
    assert_eq!((canvas.width(), canvas.height()), (width, height));
    storage.remove_item("motorlink.fleet").unwrap();

    let root = drawing.document_element().unwrap();
    assert_eq!(
        root.get_attribute("viewBox").as_deref(),
        Some("0 0 1600 960")
    );
    assert_eq!(root.get_attribute("width").as_deref(), Some("800"));
    // It is self-contained, and nothing in it runs.
    for foreign in ["image", "script", "style", "use", "[href]", "[*|href]"] {
        assert!(
            drawing.query_selector(foreign).unwrap().is_none(),
            "{foreign}"
        );
    }
    let texts = texts(&drawing);
    let has = |text: &str| texts.iter().any(|shown| shown == text);
    for text in [
        "+110 rpm",
        "+90",
        "+0.10 A",
        "\u{2212}0.10",
        "10 s",
        "now",
        "Speed (rpm)",
        "Current (A)",
    ] {
        assert!(has(text), "no {text:?} in {texts:?}");
    }
    let title = format!("Motor 0x01 {name}, 20");
    assert!(
        texts.iter().any(|text| text.starts_with(&title)),
        "{texts:?}"
    );

    // The colour of the light theme. 100 is in the middle of the upper pane, which begins 8 pixels of the screen below the top.
    let lines = paths(&drawing, "rgb(11,100,189)");
    let [line] = lines.as_slice() else {
        panic!("one line: {lines:?}")
    };
    let middle = 16.0 + (900.0 - 2.0 * 40.0) / 4.0;
    assert!(
        line.iter().all(|(_, y)| (y - middle).abs() <= 2.0),
        "{line:?}"
    );
    let (first, last) = (line[0].0, line[line.len() - 1].0);
    let plot_width = 1_600.0 - 2.0 * 104.0;
    // 5 of 10 seconds, up to now: a slow machine takes a while until it draws.
    assert!((1_100.0..=1_600.0 - 72.0).contains(&last), "{last}");
    assert!(
        ((last - first) - plot_width / 2.0).abs() <= 30.0,
        "{first} to {last}"
    );
}

#[wasm_bindgen_test]
async fn a_drawing_of_many_samples_has_two_points_a_column() {
    let bench = bench("graph-svg-many").await;
    let mut samples = steady(9_000, 100);
    for (place, sample) in samples.iter_mut().enumerate() {
        sample.reply.speed = Some(Rpm::new(if place % 2 == 0 { 100 } else { -100 }));
    }
    report(&bench, samples);
    let canvas = canvas(&bench);
    bench.until("a line", || is_drawn(&canvas)).await;
    bench.find("radio", "5 min").click();
    let drawing = saved_drawing(&bench).await;
    let points: usize = paths(&drawing, "rgb(11,100,189)")
        .iter()
        .map(Vec::len)
        .sum();
    // 9 of 300 seconds in 1,392 columns.
    assert!((20..=2 * 60).contains(&points), "{points}");
}

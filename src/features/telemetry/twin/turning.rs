//! The wheel's layer, animated by the browser along a course, so that the page does not have to draw each frame.

use js_sys::{Array, Object, Reflect};
use leptos::wasm_bindgen::JsCast;
use leptos::web_sys::{Animation, Element, FillMode, KeyframeEffect, KeyframeEffectOptions};

use crate::{
    features::telemetry::twin::{course::Course, motion::Heading},
    ui::frame_rate::{FrameRate, frame_rate},
};

/// Turns the wheel, the only part that differs in every frame.
pub struct Turning {
    element: Element,
    course: Option<Course>,
    rate: FrameRate,
    running: Option<Animation>,
}

impl Turning {
    pub(crate) fn find(picture: &Element) -> Option<Self> {
        Some(Self {
            element: picture.query_selector(".twin-turning").ok().flatten()?,
            course: None,
            rate: FrameRate::default(),
            running: None,
        })
    }

    /// Changes the course of the wheel if it deviates from the reports.
    pub(crate) fn steer(&mut self, heading: Heading, now_ms: f64) {
        let rate = frame_rate();
        let next = Course::next(self.course, heading, now_ms);
        let same_at_another_rate = self
            .course
            .filter(|course| rate != self.rate && now_ms < course.until_ms)
            .map(|course| course.from(now_ms));
        let Some(course) = next.or(same_at_another_rate) else {
            return;
        };
        self.course = Some(course);
        self.rate = rate;
        let begun = self.begin(course);
        if let Some(before) = std::mem::replace(&mut self.running, begun) {
            before.cancel();
        }
    }

    /// `None` if the browser does not support it: then the wheel does not turn, but the figures change.
    fn begin(&self, course: Course) -> Option<Animation> {
        let in_steps = self
            .rate
            .hertz()
            .map(|hertz| course.in_steps(1_000.0 / f64::from(hertz)));
        let (course, steps) = match in_steps {
            Some((course, steps)) => (course, Some(steps)),
            None => (course, None),
        };
        let lasts_ms = (course.until_ms - course.from_ms).max(0.0);
        let from_deg = course.angle_deg.rem_euclid(360.0);
        let to_deg = from_deg + course.angle_at(course.until_ms) - course.angle_deg;
        let turned = |degrees: f64| format!("rotate({degrees:.3}deg)").into();
        let keyframes = Object::new();
        let angles = Array::of2(&turned(from_deg), &turned(to_deg));
        Reflect::set(&keyframes, &"transform".into(), &angles).ok()?;
        let options = KeyframeEffectOptions::new();
        options.set_duration(&lasts_ms.into());
        if let Some(steps) = steps {
            // The browser has nothing to draw between steps. The steps are in the frames in which the rest changes.
            options.set_easing(&format!("steps({steps})"));
        }
        // The wheel stays at the end of the course.
        options.set_fill(FillMode::Forwards);
        let effect =
            KeyframeEffect::new_with_opt_element_and_keyframes_and_keyframe_effect_options(
                Some(&self.element),
                Some(&keyframes),
                &options,
            )
            .ok()?;
        let animation = Animation::new_with_effect(Some(effect.unchecked_ref())).ok()?;
        // An explicit start time: otherwise the wheel would pause for a frame each time.
        animation.set_start_time(Some(course.from_ms));
        Some(animation)
    }
}

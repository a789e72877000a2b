//! The wheel's layer. At high frame rates the browser animates it along a course, so that the page does not have to
//! draw each frame. At low ones the page turns it in the frames in which it draws anyway: the browser's steps would
//! fall between these, and each would cost a frame of its own.

use js_sys::{Array, Object, Reflect};
use leptos::wasm_bindgen::JsCast;
use leptos::web_sys::{Animation, Element, FillMode, KeyframeEffect, KeyframeEffectOptions};

use crate::{
    features::telemetry::twin::{course::Course, motion::Heading},
    ui::{
        attribute::Attribute,
        frame_rate::{FrameRate, frame_rate},
        mathematics::modulo,
        media::wants_less_motion,
    },
};

/// Turns the wheel, the only part that differs in every frame.
pub struct Turning {
    element: Element,
    /// Its angle where no animation turns it.
    turned: Attribute,
    course: Option<Course>,
    rate: FrameRate,
    running: Option<Animation>,
}

impl Turning {
    /// The wheel, or only its marks for a person who wants less motion.
    pub(crate) fn find(picture: &Element) -> Option<Self> {
        let turning = if wants_less_motion() {
            ".twin-pointer"
        } else {
            ".twin-turning"
        };
        let element = picture.query_selector(turning).ok().flatten()?;
        Some(Self {
            turned: Attribute::of(element.clone(), "transform"),
            element,
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
        let is_new = next.is_some() || same_at_another_rate.is_some();
        self.course = next.or(same_at_another_rate).or(self.course);
        self.rate = rate;
        let Some(course) = self.course else { return };
        if rate.draws_all_together() {
            self.turn_to(course, heading, now_ms);
            self.replace_animation(None);
        } else if is_new {
            let begun = self.begin(course);
            self.replace_animation(begun);
        }
    }

    fn replace_animation(&mut self, next: Option<Animation>) {
        if let Some(before) = std::mem::replace(&mut self.running, next) {
            before.cancel();
        }
    }

    /// Turns the wheel once. A wheel that comes to rest goes to its last angle: there may be no further frame.
    fn turn_to(&mut self, course: Course, heading: Heading, now_ms: f64) {
        let rests = heading.rate_deg_per_s.abs() < f64::EPSILON;
        let at_ms = if rests { course.until_ms } else { now_ms };
        self.turned.rotate(modulo(course.angle_at(at_ms), 360.0));
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
        let from_deg = modulo(course.angle_deg, 360.0);
        let to_deg = from_deg + course.angle_at(course.until_ms) - course.angle_deg;
        let turned = |degrees: f64| format!("rotate({degrees:.3}deg)").into();
        let keyframes = Object::new();
        let angles = Array::of2(&turned(from_deg), &turned(to_deg));
        Reflect::set(&keyframes, &"transform".into(), &angles).ok()?;
        let options = KeyframeEffectOptions::new();
        options.set_duration(&lasts_ms.into());
        if let Some(steps) = steps {
            // The browser has nothing to draw between steps. The steps are in the frames in which the rest changes.
            options.set_easing(&format!("steps({steps:.0})"));
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

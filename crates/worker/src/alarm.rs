//! One wake-up at a precise moment.
//!
//! `setTimeout` is clamped to 4 ms in workers too, half a drive period at 125 Hz.
//! `scheduler.postTask` is late by 0.3 ms at the 99th percentile, and up to 0.4 ms early. Its priority
//! is that of messages: with a higher one, a bus that always has something due keeps the page's
//! answers waiting, and the watchdog takes a page for dead that lives.

use std::{cell::Cell, rc::Rc, time::Duration};

use gloo_timers::callback::Timeout;
use motorlink_protocol::Instant;
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{Scheduler, SchedulerPostTaskOptions, TaskPriority, WorkerGlobalScope};

use crate::scope::{Clock, global};

/// A task that comes this early is the one that was armed: 0.4 ms, and steps of 0.1 ms of the clock.
const EARLY: Duration = Duration::from_millis(1);

/// Calls one function at the moments it was armed for, and sometimes earlier: whoever is called
/// looks at the clock.
pub(crate) struct Alarm {
    task: Closure<dyn FnMut() -> JsValue>,
    ring_if_due: Rc<dyn Fn()>,
    scheduler: Option<Scheduler>,
    options: SchedulerPostTaskOptions,
    /// The earliest moment that a task is under way for. A later one need not be armed: the call
    /// that comes earlier arms it again. So there are few tasks, however often the moment moves.
    armed: Rc<Cell<Option<Instant>>>,
}

impl Alarm {
    pub(crate) fn new(clock: Clock, ring: impl Fn() + 'static) -> Self {
        let armed: Rc<Cell<Option<Instant>>> = Rc::default();
        let ring_if_due: Rc<dyn Fn()> = {
            let armed = Rc::clone(&armed);
            Rc::new(move || {
                // A task that was overtaken comes too late to matter. If it rang, whoever is called
                // would arm the next moment beside the task that is under way for it, and from then
                // on there would be two chains of tasks, then three.
                if armed.get().is_some_and(|at| clock.now() + EARLY >= at) {
                    armed.set(None);
                    ring();
                }
            })
        };
        let on_task = Rc::clone(&ring_if_due);
        let task = Closure::new(move || {
            on_task();
            JsValue::UNDEFINED
        });
        let options = SchedulerPostTaskOptions::new();
        options.set_priority(TaskPriority::UserVisible);
        Self {
            task,
            ring_if_due,
            scheduler: scheduler(),
            options,
            armed,
        }
    }

    pub(crate) fn arm(&self, now: Instant, at: Instant) {
        if self
            .armed
            .get()
            .is_some_and(|armed| armed <= at && armed > now)
        {
            return;
        }
        self.armed.set(Some(at));
        let delay = at.since(now);
        if let Some(scheduler) = &self.scheduler {
            self.options.set_delay_f64(delay.as_secs_f64() * 1000.0);
            let task = self.task.as_ref().unchecked_ref();
            let _ = scheduler.post_task_with_options(task, &self.options);
        } else {
            let ring = Rc::clone(&self.ring_if_due);
            let millis = u32::try_from(delay.as_millis()).unwrap_or(u32::MAX);
            Timeout::new(millis, move || ring()).forget();
        }
    }
}

/// `scheduler.postTask`, where the browser has it.
fn scheduler() -> Option<Scheduler> {
    let scope: WorkerGlobalScope = global().unchecked_into();
    let there = js_sys::Reflect::has(&scope, &"scheduler".into()).unwrap_or(false);
    there.then(|| scope.scheduler())
}

#[cfg(test)]
mod tests {
    use gloo_timers::future::sleep;
    use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

    use super::*;
    use crate::scope::Clock;

    wasm_bindgen_test_configure!(run_in_dedicated_worker);

    /// An alarm that notes when it rang.
    fn noting() -> (Clock, Alarm, Rc<Cell<Option<Instant>>>) {
        let clock = Clock::new();
        let rang = Rc::new(Cell::new(None));
        let alarm = Alarm::new(clock.clone(), {
            let (clock, rang) = (clock.clone(), Rc::clone(&rang));
            move || rang.set(Some(clock.now()))
        });
        (clock, alarm, rang)
    }

    #[wasm_bindgen_test]
    async fn it_rings_once_it_is_time() {
        let (clock, alarm, rang) = noting();
        let at = clock.now() + Duration::from_millis(30);
        alarm.arm(clock.now(), at);
        sleep(Duration::from_millis(10)).await;
        assert_eq!(rang.get(), None, "20 ms to go");
        sleep(Duration::from_millis(500)).await;
        assert!(
            rang.get()
                .is_some_and(|rang| rang + Duration::from_millis(1) >= at)
        );
    }

    #[wasm_bindgen_test]
    async fn an_earlier_moment_overtakes_and_a_later_one_does_not_delay() {
        let (clock, alarm, rang) = noting();
        let now = clock.now();
        alarm.arm(now, now + Duration::from_secs(60));
        alarm.arm(now, now + Duration::from_millis(20));
        alarm.arm(now, now + Duration::from_secs(30));
        sleep(Duration::from_millis(500)).await;
        assert!(rang.get().is_some());
    }

    #[wasm_bindgen_test]
    async fn it_can_be_armed_again_after_it_rang() {
        let (clock, alarm, rang) = noting();
        for _ in 0..3 {
            rang.set(None);
            let now = clock.now();
            alarm.arm(now, now + Duration::from_millis(5));
            sleep(Duration::from_millis(300)).await;
            assert!(rang.get().is_some());
        }
    }

    /// As the station does while a motor is driven: every ring arms the near end of a reply window,
    /// then the later moment of the next frame.
    #[wasm_bindgen_test]
    async fn overtaken_tasks_do_not_multiply() {
        let clock = Clock::new();
        let rings = Rc::new(Cell::new(0_u32));
        let alarm: Rc<Cell<Option<Alarm>>> = Rc::default();
        let in_ring = (clock.clone(), Rc::clone(&rings), Rc::clone(&alarm));
        let first = Alarm::new(clock.clone(), move || {
            let (clock, rings, alarm) = &in_ring;
            rings.set(rings.get() + 1);
            if let Some(armed) = alarm.take() {
                let now = clock.now();
                armed.arm(now, now + Duration::from_millis(20));
                armed.arm(now, now + Duration::from_millis(6));
                alarm.set(Some(armed));
            }
        });
        first.arm(clock.now(), clock.now() + Duration::from_millis(1));
        alarm.set(Some(first));
        sleep(Duration::from_secs(2)).await;
        // One chain rings every 6 ms or more; chains that multiplied would ring ten times as often.
        assert!(rings.get() <= 2_000 / 5, "{} rings in 2 s", rings.get());
        alarm.take();
    }
}

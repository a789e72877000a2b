//! A precise timer.
//!
//! | mechanism | measured |
//! |---|---|
//! | `Atomics.waitAsync` on private memory | never early, 0.2 ms late at most |
//! | `scheduler.postTask` | counts whole milliseconds, so up to 1 ms early: it has to be armed again |
//! | `setTimeout` | clamped to 4 ms, in workers too: half a drive period at 125 Hz |
//!
//! None of them may have priority over messages: on a bus where something is always due, the page's
//! answers would wait, and the watchdog would stop the motors although the page answers.

use std::{cell::Cell, rc::Rc, time::Duration};

use gloo_timers::callback::Timeout;
use js_sys::{Atomics, Int32Array, Object, Promise, Reflect, WebAssembly::Memory};
use motorlink_protocol::Instant;
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{Scheduler, SchedulerPostTaskOptions, TaskPriority, WorkerGlobalScope};

use crate::scope::{Clock, global};

/// How much too early a task may run and still count as the armed one.
const EARLY: Duration = Duration::from_millis(1);

/// A shorter wait would end at once, in the same turn of the event loop.
const SHORTEST_MS: f64 = 0.05;

/// Calls a function at the armed time, and sometimes earlier: the function has to check the clock.
pub(crate) struct Alarm {
    call_if_due: Rc<dyn Fn()>,
    async_wait: Option<AsyncWait>,
    scheduler: Option<PostTask>,
    /// The earliest time for which a task is pending. A later time needs no task: the earlier call
    /// arms the alarm again. So few tasks are pending, however often the time changes.
    armed: Rc<Cell<Option<Instant>>>,
}

impl Alarm {
    pub(crate) fn new(clock: Clock, ring: impl Fn() + 'static) -> Self {
        let armed: Rc<Cell<Option<Instant>>> = Rc::default();
        let call_if_due: Rc<dyn Fn()> = {
            let armed = Rc::clone(&armed);
            Rc::new(move || {
                // A task whose time was replaced by an earlier one must not ring. It would arm the next
                // time although a task is pending for it, and the number of tasks would grow.
                if armed.get().is_some_and(|at| clock.now() + EARLY >= at) {
                    armed.set(None);
                    ring();
                }
            })
        };
        Self {
            async_wait: AsyncWait::new(Rc::clone(&call_if_due)),
            scheduler: PostTask::new(Rc::clone(&call_if_due)),
            call_if_due,
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
        let delay_ms = delay.as_secs_f64() * 1000.0;
        if self
            .async_wait
            .as_ref()
            .is_some_and(|async_wait| async_wait.wait(delay_ms))
        {
            return;
        }
        if let Some(scheduler) = &self.scheduler {
            scheduler.post(delay_ms);
        } else {
            let ring = Rc::clone(&self.call_if_due);
            let millis = u32::try_from(delay.as_millis()).unwrap_or(u32::MAX);
            Timeout::new(millis, move || ring()).forget();
        }
    }
}

/// `Atomics.waitAsync` on private shared memory: a wait that does not block and always times out.
struct AsyncWait {
    place: Int32Array,
    value: JsValue,
    on_woken: Closure<dyn FnMut(JsValue)>,
}

impl AsyncWait {
    /// `None` where the browser has no `Atomics.waitAsync`.
    fn new(ring: Rc<dyn Fn()>) -> Option<Self> {
        let atomics = Reflect::get(&js_sys::global(), &"Atomics".into()).ok()?;
        if !Reflect::has(&atomics, &"waitAsync".into()).unwrap_or(false) {
            return None;
        }
        let pages = Object::new();
        for (name, value) in [
            ("initial", JsValue::from(1)),
            ("maximum", JsValue::from(1)),
            ("shared", JsValue::TRUE),
        ] {
            Reflect::set(&pages, &name.into(), &value).ok()?;
        }
        let memory = Memory::new(&pages).ok()?;
        Some(Self {
            place: Int32Array::new(&memory.buffer()),
            value: "value".into(),
            on_woken: Closure::new(move |_| ring()),
        })
    }

    /// Rings after this delay. Returns false if the browser refuses.
    fn wait(&self, delay_ms: f64) -> bool {
        let delay_ms = delay_ms.max(SHORTEST_MS);
        let waiting = Atomics::wait_async_with_timeout(&self.place, 0, 0, delay_ms);
        let woken = waiting.and_then(|waiting| Reflect::get(&waiting, &self.value));
        // The value is not a promise if the wait ended at once.
        let Ok(woken) = woken.and_then(JsCast::dyn_into::<Promise>) else {
            return false;
        };
        let _ = woken.then(&self.on_woken);
        true
    }
}

/// `scheduler.postTask`.
struct PostTask {
    scheduler: Scheduler,
    options: SchedulerPostTaskOptions,
    task: Closure<dyn FnMut() -> JsValue>,
}

impl PostTask {
    /// `None` where the browser has no scheduler.
    fn new(ring: Rc<dyn Fn()>) -> Option<Self> {
        let scope: WorkerGlobalScope = global().unchecked_into();
        let there = Reflect::has(&scope, &"scheduler".into()).unwrap_or(false);
        let options = SchedulerPostTaskOptions::new();
        options.set_priority(TaskPriority::UserVisible);
        there.then(|| Self {
            scheduler: scope.scheduler(),
            options,
            task: Closure::new(move || {
                ring();
                JsValue::UNDEFINED
            }),
        })
    }

    fn post(&self, delay_ms: f64) {
        self.options.set_delay_f64(delay_ms);
        let task = self.task.as_ref().unchecked_ref();
        let _ = self.scheduler.post_task_with_options(task, &self.options);
    }
}

#[cfg(test)]
mod tests {
    use gloo_timers::future::sleep;
    use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

    use super::*;
    use crate::scope::Clock;

    wasm_bindgen_test_configure!(run_in_dedicated_worker);

    /// A clock, an alarm, and the time when the alarm last rang.
    fn recording_alarm() -> (Clock, Alarm, Rc<Cell<Option<Instant>>>) {
        let clock = Clock::new();
        let rang = Rc::new(Cell::new(None));
        let alarm = Alarm::new(clock.clone(), {
            let (clock, rang) = (clock.clone(), Rc::clone(&rang));
            move || rang.set(Some(clock.now()))
        });
        (clock, alarm, rang)
    }

    #[wasm_bindgen_test]
    async fn it_rings_at_the_armed_time() {
        let (clock, alarm, rang) = recording_alarm();
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
    async fn an_earlier_time_replaces_a_later_one_and_a_later_one_does_not_delay() {
        let (clock, alarm, rang) = recording_alarm();
        let now = clock.now();
        alarm.arm(now, now + Duration::from_secs(60));
        alarm.arm(now, now + Duration::from_millis(20));
        alarm.arm(now, now + Duration::from_secs(30));
        sleep(Duration::from_millis(500)).await;
        assert!(rang.get().is_some());
    }

    #[wasm_bindgen_test]
    async fn it_can_be_armed_again_after_it_rang() {
        let (clock, alarm, rang) = recording_alarm();
        for _ in 0..3 {
            rang.set(None);
            let now = clock.now();
            alarm.arm(now, now + Duration::from_millis(5));
            sleep(Duration::from_millis(300)).await;
            assert!(rang.get().is_some());
        }
    }

    /// As the worker does while a motor is driven: every ring arms the alarm for the next frame, then
    /// for the earlier end of a reply window.
    #[wasm_bindgen_test]
    async fn replaced_tasks_do_not_multiply() {
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

//! The clock of the driver: monotonic, and it counts the time asleep.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use motorlink_messages::AwakeClock;
use motorlink_protocol::Instant;

/// The wall clock at [`Instant::ZERO`], in microseconds since 1970, where it is `now` now.
#[must_use]
pub fn zero_unix_us(now: Instant) -> i64 {
    let unix = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    let zero = unix.saturating_sub(Duration::from_micros(now.as_micros()));
    i64::try_from(zero.as_micros()).unwrap_or_default()
}

/// A clock that begins a second after [`Instant::ZERO`], so that a moment just before it can be told.
#[derive(Debug)]
pub struct Clock {
    began: std::time::Instant,
    awake: AwakeClock,
}

impl Clock {
    /// A new clock.
    #[must_use]
    pub fn new() -> Self {
        Self {
            began: std::time::Instant::now(),
            awake: AwakeClock::default(),
        }
    }

    /// The time.
    pub fn now(&mut self) -> Instant {
        let monotonic = self.began.elapsed() + Duration::from_secs(1);
        let wall = SystemTime::now().duration_since(UNIX_EPOCH);
        let wall = wall.unwrap_or_default();
        let ms = |duration: Duration| duration.as_secs_f64() * 1000.0;
        let now = self.awake.read(ms(monotonic), ms(wall)) / 1000.0;
        let now = Duration::try_from_secs_f64(now).unwrap_or(monotonic);
        Instant::ZERO + now
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

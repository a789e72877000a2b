//! Stores the overview as a JSON attachment.

use std::{collections::BTreeMap, time::Duration};

use motorlink_bus::LineSamples;
use motorlink_messages::sessions::FaultChange;
use motorlink_protocol::{Current, Faults, Instant, MotorId, Rpm, family::Model};
use nojson::{DisplayJson, JsonFormatter, RawJson, RawJsonValue};

use super::{
    BUCKETS_MAX, Extent, FaultChanges, MARKS_MAX, Mark, MotorOverview, Overview, bookmarks_in,
    faults::CHANGES_MAX,
};
use crate::{channels::integer, record::EventKind};

/// The version of the format. An overview of another version is computed again.
const VERSION: u8 = 1;

impl DisplayJson for Extent {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        f.array(|f| {
            f.elements([self.speed.0.rpm(), self.speed.1.rpm()])?;
            // Without a current the bucket has two numbers.
            let current = self.current.map(|(least, most)| [least.raw(), most.raw()]);
            f.elements(current.into_iter().flatten())
        })
    }
}

impl DisplayJson for Mark {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        f.object(|f| {
            f.member("after_us", micros(self.after))?;
            f.member("kind", self.kind.name())?;
            f.member("error", self.error)?;
            f.member("text", &self.text)
        })
    }
}

/// A change of faults.
struct Change<'a>(&'a FaultChange);

impl DisplayJson for Change<'_> {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        let FaultChange { at, id, faults } = self.0;
        f.array(|f| {
            f.elements([at.as_micros(), id.get().into()])?;
            // A motor that stopped answering has none.
            f.elements(faults.map(|faults| u64::from(faults.byte())))
        })
    }
}

/// A motor with its ID.
struct Motor<'a>(MotorId, &'a MotorOverview);

impl DisplayJson for Motor<'_> {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        let Self(id, motor) = self;
        f.object(|f| {
            f.member("id", id.get())?;
            f.member("sent", motor.sent)?;
            f.member("replies", motor.replies)?;
            f.member("lost", motor.lost)?;
            f.member("fault_code", motor.faults.byte())?;
            let model = motor.faults.model();
            if model != Model::default() {
                f.member("model", model.spec().key)?;
            }
            f.member("temperature_max_c", motor.temperature_max_c)?;
            f.member("buckets", &motor.buckets)
        })
    }
}

impl Overview {
    /// The overview as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        let moment =
            |moment: Option<(Instant, u64)>| moment.map(|(at, utc_ns)| [at.as_micros(), utc_ns]);
        let motors = nojson::array(|f| f.elements(self.motors().map(|(id, m)| Motor(id, m))));
        let changes = nojson::array(|f| f.elements(self.faults.all().iter().map(Change)));
        let json = nojson::object(|f| {
            f.member("version", VERSION)?;
            f.member("bucket_us", self.bucket_us)?;
            f.member("first", moment(self.first))?;
            f.member("last", moment(self.last))?;
            f.member("line_events", self.line_events)?;
            f.member("sent", self.sent)?;
            f.member("received", self.received)?;
            f.member("lost", self.lost)?;
            f.member("junk", self.junk)?;
            f.member("not_sent", self.not_sent)?;
            f.member("motors", &motors)?;
            f.member("fault_changes", &changes)?;
            f.member("marks", &self.marks)?;
            f.member("marks_left_out", self.marks_left_out)
        });
        json.to_string()
    }

    /// Parses an overview; `None` if it is invalid, of another version, or of one that lacks a part.
    #[must_use]
    pub fn from_json(json: &[u8]) -> Option<Self> {
        let json = RawJson::parse(std::str::from_utf8(json).ok()?).ok()?;
        let value = json.value();
        let number = |name| integer::<u64>(value, name);
        if number("version")? != VERSION.into() {
            return None;
        }
        let moment = |name| {
            let pair = value.to_member(name).ok()?.optional()?;
            // An empty session has none.
            if pair.kind().is_null() {
                return Some(None);
            }
            let [at, utc_ns] = numbers(pair)?;
            Some(Some((Instant::from_micros(at), utc_ns)))
        };
        let (first, last) = (moment("first")?, moment("last")?);
        let elements = |name| value.to_member(name).ok()?.optional()?.to_array().ok();
        let marks = elements("marks")?.take(MARKS_MAX).map(mark);
        let marks = marks.collect::<Option<Vec<_>>>()?;
        let motors = elements("motors")?.map(motor).collect::<Option<_>>()?;
        let changes = elements("fault_changes")?.take(CHANGES_MAX);
        let changes = changes.map(|change| fault_change(change, &motors));
        Some(Self {
            bucket_us: number("bucket_us").filter(|bucket| *bucket > 0)?,
            first,
            last,
            faults: FaultChanges::stored(changes.collect::<Option<_>>()?),
            motors,
            bookmarks: bookmarks_in(&marks),
            marks,
            samples: LineSamples::default(),
            marks_left_out: number("marks_left_out")?,
            line_events: number("line_events")?,
            sent: number("sent")?,
            received: number("received")?,
            lost: number("lost")?,
            junk: number("junk")?,
            not_sent: number("not_sent")?,
        })
    }
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

/// Parses an array of `N` numbers.
fn numbers<T: std::str::FromStr, const N: usize>(array: RawJsonValue<'_, '_>) -> Option<[T; N]> {
    let all = array.to_array().ok()?;
    let all: Option<Vec<T>> = all
        .take(N + 1)
        .map(|one| one.as_integer_str().ok()?.parse().ok())
        .collect();
    all?.try_into().ok()
}

fn mark(mark: RawJsonValue<'_, '_>) -> Option<Mark> {
    let text = |name| {
        let member = mark.to_member(name).ok()?.optional()?;
        member.to_unquoted_string_str().ok()
    };
    let error = mark.to_member("error").ok()?.optional()?;
    Some(Mark {
        after: Duration::from_micros(integer(mark, "after_us")?),
        kind: EventKind::from_name(&text("kind")?),
        error: error.as_raw_str() == "true",
        text: text("text")?.into_owned(),
    })
}

fn motor(motor: RawJsonValue<'_, '_>) -> Option<(MotorId, MotorOverview)> {
    let number = |name| integer::<u64>(motor, name);
    let buckets = motor
        .to_member("buckets")
        .ok()?
        .optional()?
        .to_array()
        .ok()?;
    let buckets = buckets.take(BUCKETS_MAX).map(|bucket| {
        if bucket.kind().is_null() {
            return Ok(None);
        }
        extent(bucket).map(Some).ok_or(())
    });
    let model = motor.to_member("model").ok()?.optional();
    let model = model.and_then(|model| model.as_raw_str().trim_matches('"').parse().ok());
    let overview = MotorOverview {
        sent: number("sent")?,
        replies: number("replies")?,
        lost: number("lost")?,
        faults: Faults::of(model.unwrap_or_default(), integer(motor, "fault_code")?),
        temperature_max_c: integer(motor, "temperature_max_c"),
        buckets: buckets.collect::<Result<_, ()>>().ok()?,
    };
    Some((MotorId::new(integer(motor, "id")?).ok()?, overview))
}

/// Parses a change of faults; those of a motor are of its model.
fn fault_change(
    change: RawJsonValue<'_, '_>,
    motors: &BTreeMap<MotorId, MotorOverview>,
) -> Option<FaultChange> {
    let numbers = change.to_array().ok()?;
    let mut numbers = numbers.map(|one| one.as_integer_str().ok()?.parse::<u64>().ok());
    let at = Instant::from_micros(numbers.next()??);
    let id = MotorId::new(u8::try_from(numbers.next()??).ok()?).ok()?;
    let model = motors.get(&id).map(|motor| motor.faults.model());
    let faults = match numbers.next() {
        Some(byte) => Some(Faults::of(
            model.unwrap_or_default(),
            u8::try_from(byte?).ok()?,
        )),
        None => None,
    };
    Some(FaultChange { at, id, faults })
}

/// Parses the values of a bucket.
fn extent(bucket: RawJsonValue<'_, '_>) -> Option<Extent> {
    if let Some([least, most]) = numbers(bucket) {
        return Some(Extent {
            speed: (Rpm::new(least), Rpm::new(most)),
            current: None,
        });
    }
    let [speed_min, speed_max, current_min, current_max] = numbers(bucket)?;
    let current = (
        Current::from_raw(current_min),
        Current::from_raw(current_max),
    );
    Some(Extent {
        speed: (Rpm::new(speed_min), Rpm::new(speed_max)),
        current: Some(current),
    })
}

//! The texts about deleted data.

use motorlink_i18n::tr;

/// The result of deleting all data.
pub(crate) fn of_erased(all: bool) -> &'static str {
    if all {
        tr!("Deleted. New data is stored from now on.")
    } else {
        tr!(
            "Deleted, except data that other MotorLink tabs use. Close those tabs and delete again."
        )
    }
}

//! Parts of views that do not depend on motors.

pub(crate) mod animation;
pub(crate) mod attribute;
pub(crate) mod button;
pub(crate) mod choice_keys;
pub(crate) mod clock;
pub(crate) mod dial;
pub(crate) mod download;
pub(crate) mod entry;
pub(crate) mod escape;
pub(crate) mod export_button;
pub(crate) mod focus;
pub(crate) mod format;
pub(crate) mod frame_rate;
pub(crate) mod list;
pub(crate) mod listener;
pub(crate) mod mathematics;
pub(crate) mod media;
pub(crate) mod number_field;
pub(crate) mod panel;
pub(crate) mod reactive;
pub(crate) mod size_watch;
pub(crate) mod slider;
pub(crate) mod tab_panel;
pub(crate) mod target;
pub(crate) mod text;

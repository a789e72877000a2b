//! The parts of the page that one sees.
//!
//! All of them are mounted once and shown or hidden; lists are text or HTML from pure functions. A
//! part that comes and goes (`Show`, `For`, children, a view in a closure) drags code along that
//! builds, compares, moves and drops every type in it: measured, 80 KB of the page's gzip.

mod button;
mod connection;
mod control;
mod drawer;
mod drive_pad;
mod export_button;
mod focus;
mod graph;
mod header;
mod help;
mod kept_session;
mod link_panel;
mod link_quality;
pub(crate) mod live;
mod motor_buttons;
mod motor_choice;
mod motor_strip;
mod notices;
mod packet_log;
mod question_dialog;
mod recording;
mod settings_panel;
mod stop_button;
mod stopped_dialog;
mod telemetry;
mod together_panel;
pub(crate) mod tour;
mod wheel_panel;

pub(crate) use control::{
    ControlPanel, CurrentTab, IdManagerTab, PositionTab, RawHexTab, VelocityTab,
};
pub(crate) use graph::{Graph, provide_graph};
pub(crate) use header::Header;
pub(crate) use help::HelpDialog;
pub(crate) use link_panel::LinkPanel;
pub(crate) use motor_strip::MotorStrip;
pub(crate) use notices::Notices;
pub(crate) use packet_log::PacketLog;
pub(crate) use question_dialog::QuestionDialog;
pub(crate) use recording::Recording;
pub(crate) use settings_panel::SettingsPanel;
pub(crate) use stopped_dialog::StoppedDialog;
pub(crate) use telemetry::Telemetry;
pub(crate) use together_panel::TogetherPanel;
pub(crate) use wheel_panel::WheelPanel;

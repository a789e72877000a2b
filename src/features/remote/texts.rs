//! The texts of the group `Remote`.

use motorlink_i18n::tr;
use motorlink_messages::remote::WhoDrives;

/// Who drives.
pub(super) fn of_control(control: WhoDrives, viewer: &str) -> String {
    let text = match control {
        WhoDrives::Off => tr!("Not connected to the server."),
        WhoDrives::Connecting => tr!("Connecting to the server…"),
        WhoDrives::OtherVersion => tr!("The server has another version. Reload the page."),
        WhoDrives::Free => tr!("Nobody drives."),
        WhoDrives::Mine => tr!("You drive."),
        WhoDrives::MineAndAsked => return tr!("Viewer {viewer} asks for control.", viewer),
        WhoDrives::Others | WhoDrives::OthersAndAsked => {
            return tr!("Viewer {viewer} drives.", viewer);
        }
    };
    text.to_owned()
}

/// What the browser does not allow without encryption, and what to do.
pub(super) fn without_encryption() -> &'static str {
    tr!("Gamepad, saved session and installation need encryption. Use --certificate or ssh -L.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_page_is_named() {
        let said = |control| of_control(control, "3 (192.168.1.20)");
        assert_eq!(said(WhoDrives::Mine), "You drive.");
        assert_eq!(said(WhoDrives::Others), "Viewer 3 (192.168.1.20) drives.");
        let asked = "Viewer 3 (192.168.1.20) asks for control.";
        assert_eq!(said(WhoDrives::MineAndAsked), asked);
    }
}

//! Opens a page in the browser of whoever sits there.

use std::process::{Command, Stdio};

/// Opens an address; nothing happens where there is no browser.
pub fn open(address: &str) {
    let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let seen = cfg!(target_os = "macos")
        || ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|v| std::env::var_os(v).is_some());
    if !seen {
        return;
    }
    let opened = Command::new(opener)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    if let Ok(mut child) = opened {
        // It ends when it has handed the address on.
        std::thread::spawn(move || child.wait());
    }
}

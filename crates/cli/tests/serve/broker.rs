//! Mosquitto.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Mosquitto on a port of its own; what it holds is kept when it ends politely.
pub struct Broker {
    child: Child,
    pub port: u16,
    folder: tempfile::TempDir,
}

impl Broker {
    /// `None`, visibly, where there is none: `apt-get install mosquitto`.
    pub fn start() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let kept = folder.path().display();
        let config = format!(
            "listener {port} 127.0.0.1\nallow_anonymous true\npersistence true\npersistence_location {kept}/\n\
             max_queued_messages 0\nmax_inflight_messages 4096\nuser root\n"
        );
        std::fs::write(folder.path().join("mosquitto.conf"), config).unwrap();
        let child = Self::spawn(folder.path());
        if child.is_none() {
            println!("SKIPPED (no test data): mosquitto (apt-get install mosquitto)");
        }
        child.map(|child| Self { child, port, folder })
    }

    fn spawn(folder: &Path) -> Option<Child> {
        let config = folder.join("mosquitto.conf");
        let started = |program: &str| {
            Command::new(program)
                .arg("-c")
                .arg(&config)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .ok()
        };
        started("mosquitto").or_else(|| started("/usr/sbin/mosquitto"))
    }

    /// Away for so long.
    pub async fn restart(&mut self, away: Duration) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
        self.child.wait().unwrap();
        tokio::time::sleep(away).await;
        self.child = Self::spawn(self.folder.path()).unwrap();
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

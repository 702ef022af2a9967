//! A disk that is full: journal and store of a server on a file system of a few MB, which is filled under load and emptied again.

use crate::served::{Served, adit, load, report};
use serde_json::json;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A file system of its own for one folder, in memory, seen by those who are run inside. Needs no rights where the system lets users have
/// namespaces.
struct SmallDisk {
    holder: Child,
    folder: tempfile::TempDir,
}

impl SmallDisk {
    /// `None`, visibly, where the system does not allow it.
    fn new(megabytes: u32) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mount =
            format!("mount -t tmpfs -o size={megabytes}m none \"$0\" && echo mounted && exec sleep infinity");
        let mut holder = Command::new("unshare");
        holder.args(["-rm", "sh", "-c", &mount]).arg(folder.path());
        let mut holder = holder.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?;
        let mut told = [0; 7];
        let read = std::io::Read::read_exact(holder.stdout.as_mut().unwrap(), &mut told);
        if read.is_err() || &told != b"mounted" {
            println!("SKIPPED (no user namespaces): a disk of {megabytes} MB");
            let _ = holder.kill();
            let _ = holder.wait();
            return None;
        }
        Some(Self { holder, folder })
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    /// A command that sees the disk.
    fn inside(&self, program: &Path) -> Command {
        let mut command = Command::new("nsenter");
        let holder = self.holder.id().to_string();
        command.args(["-t", &holder, "-U", "-m", "--preserve-credentials", "--"]).arg(program);
        command
    }

    /// Not a byte is free.
    fn fill(&self) {
        let ballast = format!("of={}", self.path().join("ballast").display());
        for bytes in ["bs=64k", "bs=512"] {
            let mut dd = self.inside(Path::new("dd"));
            dd.args(["if=/dev/zero", &ballast, bytes, "oflag=append", "conv=notrunc"]).stderr(Stdio::null());
            assert!(!dd.status().unwrap().success(), "the disk did not fill");
        }
    }

    fn empty(&self) {
        let removed = self.inside(Path::new("rm")).arg(self.path().join("ballast")).status();
        assert!(removed.unwrap().success());
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = self.holder.kill();
        let _ = self.holder.wait();
    }
}

#[tokio::test]
async fn while_the_disk_is_full_nothing_is_acknowledged_and_afterwards_it_goes_on() {
    let Some(disk) = SmallDisk::new(24) else { return };
    let binary = Path::new(env!("CARGO_BIN_EXE_adit"));
    let served = Served::run(disk.inside(binary), disk.path(), None, "127.0.0.1:0");
    let token = served.token().await;
    let load = load(
        &served.url,
        &token,
        &["--tags", "10", "--seconds", "40", "--per-gateway", "5", "--ranging-hz", "2"],
    );
    served.wait_for_positions(&token).await;
    let (tag, before) = served.positions(&token).await.pop_first().unwrap();

    disk.fill();
    // The journal is found full by the next batch, the store by the next commit.
    for _ in 0..200 {
        if served.failing().await.1.len() == 2 {
            break;
        }
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    assert_eq!(served.failing().await, (503, vec!["journal".to_owned(), "store".to_owned()]));
    // Commands are not acknowledged either, and say that it may be tried again.
    // The last page of the journal has room for a few.
    let mut refused = None;
    for number in 0..100 {
        let person = json!({ "id": format!("p{number}"), "name": "A name of ".repeat(20) });
        match served.ask("POST", "/api/v1/people", &token, Some(person.clone())).await {
            (201, _) => {}
            (503, told) if told["type"] == json!("unavailable") => {
                refused = Some(person);
                break;
            }
            other => panic!("{other:?}"),
        }
    }
    let person = refused.expect("a command that was not acknowledged");
    tokio::time::sleep(Duration::from_secs(10)).await;
    assert_eq!(served.failing().await.0, 503);
    assert_eq!(served.ask("GET", "/api/v1/live", &token, None).await.0, 200);

    disk.empty();
    served.wait_for_health(200, Duration::from_secs(20)).await;
    let report = report(load);
    println!("{report}");
    assert!(report["failed_tries"].as_u64().unwrap() > 0, "nothing was refused: {report}");
    assert_eq!((&report["packets"], &report["lost_packets"]), (&json!(400), &json!(0)), "{report}");
    // What was live meanwhile is in the history too.
    served.check_history(&token, &tag, before).await;
    let known = served
        .ask("GET", &format!("/api/v1/people/{}", person["id"].as_str().unwrap()), &token, None)
        .await
        .0
        == 200;
    let (status, told) = served.ask("POST", "/api/v1/people", &token, Some(person)).await;
    // 503 meant that it may have been done.
    assert_eq!(status, if known { 409 } else { 201 }, "{told}");

    let (_, packets) = served.ask("GET", "/api/v1/packets", &token, None).await;
    let address = served.kill();
    let again = Served::run(disk.inside(binary), disk.path(), None, &address);
    assert_eq!(again.ask("GET", "/api/v1/packets", &token, None).await.1, packets);
    again.kill();
    let check = disk.inside(binary).args(["store", "check"]).arg(disk.path().join("adit.sqlite")).output();
    let check = check.unwrap();
    let told = String::from_utf8_lossy(&check.stdout).into_owned() + &String::from_utf8_lossy(&check.stderr);
    assert!(check.status.success() && told.contains("no damage"), "{told}");
}

#[test]
fn a_second_server_on_the_folder_ends_and_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let first = Served::start(folder.path(), None, "127.0.0.1:0");
    let second = adit()
        .args(["serve", "--listen", "127.0.0.1:0", "--mine"])
        .arg(crate::served::mine())
        .arg("--data")
        .arg(folder.path())
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(1), "{told}");
    assert_eq!(
        told.trim_end(),
        format!("adit: {}: another server works on this folder", folder.path().display())
    );
    // Beside a running server.
    let store = folder.path().join("adit.sqlite");
    let copy = folder.path().join("copy.sqlite");
    let backup = adit().args(["store", "backup"]).arg(&store).arg("-o").arg(&copy).output().unwrap();
    assert!(backup.status.success(), "{}", String::from_utf8_lossy(&backup.stderr));
    for file in [&store, &copy] {
        let check = adit().args(["store", "check"]).arg(file).output().unwrap();
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stderr));
    }
    first.kill();
    Served::start(folder.path(), None, "127.0.0.1:0").kill();
}

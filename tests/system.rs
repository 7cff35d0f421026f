//! Pipes are widened where the system allows it; other files stay as they are.

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::AsFd;

use spmesh_base::system::widen_pipe;

use crate::programs::{run, start};

/// Capacity of the pipe of `file`, in bytes; `None` if it is no pipe.
#[cfg(target_os = "linux")]
fn pipe_len(file: &impl AsFd) -> Option<usize> {
    rustix::pipe::fcntl_getpipe_size(file).ok()
}

/// 1 MiB if the system grants another pipe that capacity, and otherwise the capacity of `pipe`: the system
/// may refuse a user with many pipes.
#[cfg(target_os = "linux")]
fn widest(pipe: &impl AsFd) -> Option<usize> {
    let (_reader, probe) = std::io::pipe().expect("a pipe");
    rustix::pipe::fcntl_setpipe_size(&probe, 1 << 20).ok().or_else(|| pipe_len(pipe))
}

#[test]
#[cfg(target_os = "linux")]
fn widened_pipes_hold_more_and_keep_what_they_hold() {
    let (mut reader, mut writer) = std::io::pipe().expect("a pipe");
    writer.write_all(b"before").expect("written");
    let expected = widest(&writer);
    widen_pipe(&writer);
    assert_eq!(pipe_len(&reader), expected);
    writer.write_all(b" and after").expect("written");
    drop(writer);
    let mut text = String::new();
    reader.read_to_string(&mut text).expect("read");
    assert_eq!(text, "before and after");
}

#[test]
#[cfg(target_os = "linux")]
fn what_is_no_pipe_stays_as_it_is() {
    for path in ["/dev/null", "/proc/self/exe"] {
        let file = File::open(path).expect("it is there");
        widen_pipe(&file);
        assert_eq!(pipe_len(&file), None);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn every_tool_widens_the_pipe_that_it_reads_from() {
    let points = run("spfinalize", &["-"], b"1 2 3\n4 5 6\n7 1 2\n").stdout;
    let (_narrow, probe) = std::io::pipe().expect("a pipe");
    let expected = widest(&probe);
    let cases: [(&str, &[&str]); 5] = [
        ("spfinalize", &["-"]),
        ("spdelaunay2d", &[]),
        ("tess3", &["-"]),
        ("spinfo", &["-"]),
        ("spconvert", &["-", "--to", "text"]),
    ];
    for (name, arguments) in cases {
        let (reader, mut writer) = std::io::pipe().expect("a pipe");
        // Keeps the pipe open after the tool has ended.
        let kept = reader.try_clone().expect("a second end");
        let child = start(name, arguments, reader.into());
        writer.write_all(&points).expect("written");
        drop(writer);
        let output = child.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(pipe_len(&kept), expected, "{name}");
    }
}

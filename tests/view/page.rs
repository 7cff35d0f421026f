//! Pages around pictures.

use data_encoding::BASE64;
use sha2::{Digest, Sha256};
use spmesh_base::error::ErrorKind;
use spmesh_view::{Frame, Picture};

const SVG: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10"><g id="map"></g></svg>"#;

fn page(title: &str, svg: &str, frame: Option<Frame>) -> String {
    let mut written = Vec::new();
    Picture { title: title.into(), svg: svg.into(), frame }.html(&mut written).unwrap();
    String::from_utf8(written).unwrap()
}

fn plain(title: &str, svg: &str) -> String {
    page(title, svg, None)
}

#[test]
fn titles_are_text_wherever_they_stand() {
    let written = plain(r#"a <b> & "c" </script></title> {svg}"#, SVG);
    let escaped = "a &lt;b&gt; &amp; &quot;c&quot; &lt;/script&gt;&lt;/title&gt; {svg}";
    assert_eq!(written.matches(escaped).count(), 3, "title, heading and label");
    assert_eq!(written.matches("a <b>").count(), 0);
    assert_eq!(written.matches("</script>").count(), 1);
    assert_eq!(written.matches("</title>").count(), 1);
}

#[test]
fn the_picture_is_in_the_page_unchanged() {
    let svg = format!("{}<!-- {{title}} {{0}} </script> -->", SVG);
    let written = plain("title", &svg);
    assert_eq!(written.matches(&svg).count(), 1);
    // The script begins after the picture.
    assert!(written.find(&svg).unwrap() < written.find("<script").unwrap());
    assert_eq!(written.matches(include_str!("../../src/view/page.js")).count(), 1);
}

#[test]
fn nothing_is_fetched_and_no_other_script_runs() {
    let written = plain("title", SVG);
    assert_eq!(written.matches("http:").count(), written.matches("xmlns=\"http:").count());
    for fetching in ["https:", "src=", "href=", "url(", "@import", "import "] {
        assert!(!written.contains(fetching), "{fetching}");
    }
    let digest = BASE64.encode(&Sha256::digest(include_str!("../../src/view/page.js")));
    let policy = format!(
        "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{digest}';"
    );
    assert!(written.contains(&policy), "the script changed: page.html must allow sha256-{digest}");
}

#[test]
fn the_frame_is_written_to_the_last_bit() {
    let frame = Frame { left: 4_000_000.1, top: -1e-300, unit: 0.1 + 0.2 };
    let written = page("title", SVG, Some(frame));
    for (name, value) in [("left", frame.left), ("top", frame.top), ("unit", frame.unit)] {
        let (_, rest) = written.split_once(&format!("data-{name}=\"")).unwrap();
        let (number, _) = rest.split_once('"').unwrap();
        assert_eq!(number.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{name}");
    }
    assert!(!plain("title", SVG).contains("data-unit="), "a picture that is not seen from above");
}

#[test]
fn a_full_disk_is_an_error() {
    let mut disk = [0; 100];
    let picture = Picture { title: String::new(), svg: SVG.into(), frame: None };
    let written = picture.html(&mut disk.as_mut_slice());
    assert_eq!(written.unwrap_err().kind(), ErrorKind::Io);
}

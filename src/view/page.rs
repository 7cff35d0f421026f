//! Pages around pictures: one HTML file that needs nothing else, with pan and zoom.

use std::io::Write;

use quick_xml::escape::escape;

use super::picture::Frame;
use spmesh_base::error::{Error, Result};

/// A picture, and the text of its page.
pub(super) struct Page<'a> {
    /// The title of the page, as plain text.
    pub(super) title: &'a str,
    /// The `<svg>` element. Its view box begins at zero. The page zooms `<g id="map">`, which has no
    /// transform. A path in `<g id="scale">` is the scale bar; a text there is its length in world units, a
    /// blank, and the name of the unit.
    pub(super) svg: &'a str,
    /// Where the map is in the world; `None` for an oblique view.
    pub(super) frame: Option<&'a Frame>,
}

/// Writes a page as one file. Its content policy blocks everything outside the file, and all scripts but its
/// own.
pub(super) fn write(output: &mut impl Write, page: &Page) -> Result<()> {
    let frame = page.frame.map_or_else(String::new, |Frame { left, top, unit }| {
        format!(" data-left=\"{left:?}\" data-top=\"{top:?}\" data-unit=\"{unit:?}\"")
    });
    write!(
        output,
        include_str!("page.html"),
        title = escape(page.title),
        frame = frame,
        style = include_str!("page.css"),
        svg = page.svg,
        script = include_str!("page.js"),
    )
    .map_err(|error| Error::io("writing the page", error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use data_encoding::BASE64;
    use sha2::{Digest, Sha256};
    use spmesh_base::error::ErrorKind;

    const SVG: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10"><g id="map"></g></svg>"#;

    fn page(title: &str, svg: &str, frame: Option<&Frame>) -> String {
        let mut written = Vec::new();
        write(&mut written, &Page { title, svg, frame }).unwrap();
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
        assert_eq!(written.matches(include_str!("page.js")).count(), 1);
    }

    #[test]
    fn nothing_is_fetched_and_no_other_script_runs() {
        let written = plain("title", SVG);
        assert_eq!(written.matches("http:").count(), written.matches("xmlns=\"http:").count());
        for fetching in ["https:", "src=", "href=", "url(", "@import", "import "] {
            assert!(!written.contains(fetching), "{fetching}");
        }
        let digest = BASE64.encode(&Sha256::digest(include_str!("page.js")));
        let policy = format!(
            "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{digest}';"
        );
        assert!(written.contains(&policy), "the script changed: page.html must allow sha256-{digest}");
    }

    #[test]
    fn the_frame_is_written_to_the_last_bit() {
        let frame = Frame { left: 4_000_000.1, top: -1e-300, unit: 0.1 + 0.2 };
        let written = page("title", SVG, Some(&frame));
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
        let written = write(&mut disk.as_mut_slice(), &Page { title: "", svg: SVG, frame: None });
        assert_eq!(written.unwrap_err().kind(), ErrorKind::Io);
    }
}

//! One HTML file with pictures in rows.

use base64::Engine;

use crate::page::{escape, fill};
use crate::{Image, ViewerError};

const TEMPLATE: &str = include_str!("../page/gallery.html");
const STYLE: &str = include_str!("../page/gallery.css");

/// Pictures in rows, each of one thing and those like it.
#[derive(Clone, Debug)]
pub struct Gallery {
    /// Title of the page.
    pub title: String,
    /// What the page shows, in a sentence or two.
    pub lead: String,
    /// The rows.
    pub rows: Vec<GalleryRow>,
}

/// A picture, and those beside it.
#[derive(Clone, Debug)]
pub struct GalleryRow {
    /// What the row is about.
    pub subject: GalleryPicture,
    /// What is like it, in order.
    pub others: Vec<GalleryPicture>,
}

/// A picture and what is written below it.
#[derive(Clone, Debug)]
pub struct GalleryPicture {
    /// The picture; it is shown at half its size in pixels, so that it is crisp on fine screens.
    pub image: Image,
    /// Its name.
    pub label: String,
    /// Its numbers, one line.
    pub numbers: String,
}

/// One HTML file with pictures in rows, without scripts or network: a search and what it found.
///
/// Size: 4/3 of the pictures as PNG. The same pictures give the same bytes.
///
/// # Errors
/// [`ViewerError::Png`] for an empty picture.
///
/// ```
/// use mser3d_viewer::{Gallery, GalleryPicture, GalleryRow, Image, PALETTE, gallery};
///
/// let picture = |label: &str| {
///     let image = Image::new(80, 60, PALETTE[0].middle)?;
///     Ok::<_, mser3d_viewer::ViewerError>(GalleryPicture { image, label: label.into(), numbers: "1 %".into() })
/// };
/// let row = GalleryRow { subject: picture("wanted")?, others: vec![picture("found")?] };
/// let html = gallery(&Gallery { title: "A search".into(), lead: String::new(), rows: vec![row] })?;
/// assert!(html.starts_with("<!DOCTYPE html>") && html.matches("<img").count() == 2);
/// # Ok::<(), mser3d_viewer::ViewerError>(())
/// ```
pub fn gallery(gallery: &Gallery) -> Result<String, ViewerError> {
    let mut rows = String::new();
    for row in &gallery.rows {
        rows.push_str("<section>\n");
        figure(&mut rows, "subject", &row.subject)?;
        rows.push_str("<ol>\n");
        for other in &row.others {
            rows.push_str("<li>");
            figure(&mut rows, "other", other)?;
        }
        rows.push_str("</ol>\n</section>\n");
    }
    let parts = [
        ("{{title}}", escape(&gallery.title)),
        ("{{lead}}", escape(&gallery.lead)),
        ("{{style}}", STYLE.to_owned()),
        ("{{rows}}", rows),
    ];
    Ok(fill(TEMPLATE, &parts))
}

fn figure(html: &mut String, class: &str, picture: &GalleryPicture) -> Result<(), ViewerError> {
    let mut png = Vec::new();
    picture.image.write_png(&mut png)?;
    let (label, numbers) = (escape(&picture.label), escape(&picture.numbers));
    let (width, height) = (picture.image.width().div_ceil(2), picture.image.height().div_ceil(2));
    html.push_str(&format!("<figure class=\"{class}\"><img src=\"data:image/png;base64,"));
    base64::engine::general_purpose::STANDARD.encode_string(&png, html);
    html.push_str(&format!(
        "\" width=\"{width}\" height=\"{height}\" alt=\"{label}\"><figcaption><b>{label}</b>{numbers}</figcaption></figure>\n"
    ));
    Ok(())
}

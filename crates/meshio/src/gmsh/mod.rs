//! Gmsh's files (`.msh`), versions 2, 4.0 and 4.1: sections between `$Name` and `$EndName`, as text or as
//! bytes.

mod elements;
mod kinds;
mod nodes;
mod source;

use crate::cells::Cells;
use crate::error::Fault;
use crate::read::Parsed;
use nodes::Nodes;
use source::Source;

/// The versions that differ.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Version {
    V2,
    V40,
    V41,
}

pub(crate) fn parse(bytes: &[u8]) -> Result<Parsed, Fault> {
    let (version, mut source) = header(bytes)?;
    let (mut nodes, none) = (None, Nodes::default());
    let mut cells = Cells::default();
    let mut has_elements = false;
    while let Some(section) = source.next_section()? {
        match section {
            // Elements that were read name those of the first.
            b"Nodes" if nodes.is_some() => {
                return Err(source.fault("$Nodes come a second time; a file holds one mesh"));
            }
            b"Nodes" => nodes = Some(Nodes::read(&mut source, version)?),
            b"Elements" => {
                elements::read(&mut source, version, nodes.as_ref().unwrap_or(&none), &mut cells)?;
                has_elements = true;
            }
            _ => {}
        }
        source.end_section(section)?;
    }
    if !has_elements {
        return Err(
            source.fault("there is no section $Elements; the file is truncated; copy or export it again")
        );
    }
    cells.into_mesh(nodes.unwrap_or_default().positions)
}

/// `$MeshFormat`, `version binary bytes`, and in binary files a 1 that shows the byte order.
fn header(bytes: &[u8]) -> Result<(Version, Source<'_>), Fault> {
    let mut source = Source::new(bytes);
    let alien = "a .msh file of Gmsh begins with $MeshFormat; this one doesn't (is it Fluent's?)";
    let mut first = source.next_section().map_err(|_| source.fault(alien))?;
    while first == Some(b"Comments") {
        source.end_section(b"Comments")?;
        first = source.next_section()?;
    }
    if first == Some(b"NOD") {
        return Err(source.unsupported(
            "version 1 of .msh is not supported; save it again by Gmsh (gmsh -save -format msh41)",
        ));
    }
    if first != Some(b"MeshFormat") {
        return Err(source.fault(alien));
    }
    let number = source.tokens.number("the version")?;
    let version = match number {
        n if (2.0..3.0).contains(&n) => Version::V2,
        n if (4.05..5.0).contains(&n) => Version::V41,
        n if (4.0..4.05).contains(&n) => Version::V40,
        _ => {
            let reason = format!(
                "version {number} of .msh is not supported, only 2 and 4; save it again by Gmsh (-format msh41)"
            );
            return Err(source.unsupported(&reason));
        }
    };
    let binary = source.tokens.whole::<u8>("the kind of file (0 or 1)")? == 1;
    let size = source.tokens.whole::<u8>("the size of a number")?;
    if binary {
        if size != 8 {
            return Err(source.unsupported(&format!("numbers of {size} bytes are not supported, only of 8")));
        }
        source.begin_binary()?;
    }
    source.end_section(b"MeshFormat")?;
    Ok((version, source))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: &str = "$Nodes\n5\n7 0 0 0\n1 1 0 0\n9 0 1 0\n4 0 0 1\n2 9 9 9\n$EndNodes\n";

    #[test]
    fn node_tags_may_come_in_any_order() {
        let text = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"a b\"\n$EndPhysicalNames\n{NODES}\
             $Elements\n3\n1 15 2 0 1 7\n2 2 2 5 1 7 1 9\n3 4 2 1 1 7 1 9 4\n$EndElements\n"
        );
        let parsed = parse(text.as_bytes()).unwrap();
        assert_eq!(parsed.vertices[4], [9.0; 3]);
        assert_eq!(parsed.triangles, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
        assert_eq!(
            parsed.notes,
            [
                "the mesh is the boundary of 1 volume cells",
                "1 triangles or polygons beside the volume cells left out",
                "1 points left out"
            ]
        );
    }

    #[test]
    fn comments_may_come_first() {
        let text = format!(
            "$Comments\nmade by hand\n$EndComments\n$MeshFormat\n2 0 8\n$EndMeshFormat\n{NODES}\
             $Elements\n1\n3 4 0 7 1 9 4\n$EndElements\n"
        );
        assert_eq!(parse(text.as_bytes()).unwrap().triangles.len(), 4);
    }

    #[test]
    fn nodes_that_come_a_second_time_are_refused() {
        let text = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{NODES}$Elements\n1\n3 4 0 7 1 9 4\n$EndElements\n\
             $Nodes\n1\n7 0 0 0\n$EndNodes\n"
        );
        let message = parse(text.as_bytes()).map(|_| ()).unwrap_err().in_file("a.msh".as_ref()).to_string();
        assert!(message.contains("$Nodes come a second time"), "{message}");
    }

    #[test]
    fn what_is_wrong_is_named_by_its_line() {
        let with = |elements: &str| {
            let text =
                format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{NODES}$Elements\n{elements}$EndElements\n");
            parse(text.as_bytes()).map(|_| ()).unwrap_err().in_file("a.msh".as_ref()).to_string()
        };
        assert_eq!(
            with("1\n1 4 2 1 1 7 1 9 3\n"),
            "a.msh:14: an element names node 3, which $Nodes does not list"
        );
        assert!(with("1\n1 200 2 1 1 7\n").contains("type 200"));
        assert!(with("99999999999\n1 4 2 1 1 7 1 9 4\n").contains("declared"));
        let old = parse(b"$NOD\n1\n1 0 0 0\n$ENDNOD\n").map(|_| ()).unwrap_err();
        assert!(format!("{old:?}").contains("version 1"));
    }
}

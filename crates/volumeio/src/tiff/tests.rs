use super::*;
use std::io::Cursor;

/// A file of pages with these entries, little end first: tag, kind and values; of tag 273 the values are the data.
type Entries<'a> = Vec<(u16, u16, Vec<u8>)>;

fn short(tag: u16, value: u16) -> (u16, u16, Vec<u8>) {
    (tag, 3, value.to_le_bytes().to_vec())
}

fn fraction(tag: u16, over: u32, under: u32) -> (u16, u16, Vec<u8>) {
    (tag, 5, [over.to_le_bytes(), under.to_le_bytes()].concat())
}

fn text(value: &str) -> (u16, u16, Vec<u8>) {
    (270, 2, [value.as_bytes(), b"\0"].concat())
}

/// Entries of a page of `width` x `height` pixels of `bits` bits.
fn page(width: u16, height: u16, bits: u16, data: &[u8]) -> Entries<'static> {
    vec![short(256, width), short(257, height), short(258, bits), short(262, 1), (273, 0, data.to_vec())]
}

fn file(pages: &[Entries]) -> Vec<u8> {
    let mut bytes = b"II\x2a\0\0\0\0\0".to_vec();
    let mut link = 4;
    for entries in pages {
        let mut table = Vec::new();
        let mut entries = entries.clone();
        entries.sort_by_key(|e| e.0);
        for (tag, kind, value) in &entries {
            let at = (bytes.len() as u32).to_le_bytes();
            if *kind == 0 {
                bytes.extend(value);
                for (tag, number) in [(273u16, at), (279, (value.len() as u32).to_le_bytes())] {
                    table.push(
                        [&tag.to_le_bytes()[..], &4u16.to_le_bytes(), &1u32.to_le_bytes(), &number].concat(),
                    );
                }
                continue;
            }
            let width = [1, 1, 2, 4, 8][usize::from(*kind) - 1];
            let count = (value.len() / width) as u32;
            let mut field = value.clone();
            if field.len() > 4 {
                bytes.extend(value);
                field = at.to_vec();
            }
            field.resize(4, 0);
            table.push([&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &field].concat());
        }
        let at = (bytes.len() as u32).to_le_bytes();
        bytes[link..link + 4].copy_from_slice(&at);
        bytes.extend((table.len() as u16).to_le_bytes());
        bytes.extend(table.concat());
        link = bytes.len();
        bytes.extend([0; 4]);
    }
    bytes
}

fn read_pages(pages: &[Entries]) -> LoadedVolume {
    read(Cursor::new(file(pages)), &ReadLimits::default())
        .unwrap_or_else(|e| panic!("{}", e.in_file("a.tif".as_ref())))
}

fn refused(pages: &[Entries]) -> String {
    read(Cursor::new(file(pages)), &ReadLimits::default()).unwrap_err().in_file("a.tif".as_ref()).to_string()
}

#[test]
fn pages_become_layers_and_rows_y() {
    let pages = [page(3, 2, 8, &[1, 2, 3, 4, 5, 6]), page(3, 2, 8, &[7, 8, 9, 10, 11, 12])];
    let loaded = read_pages(&pages);
    assert_eq!((loaded.volume.dims(), loaded.volume.channels()), ([3, 2, 2], 1));
    assert_eq!(*loaded.volume.samples(), Samples::U8((1..=12).collect()));
    assert_eq!((loaded.notes, &loaded.placed_by[..]), (vec![], "nothing: voxels of size 1"));
    let whole = file(&pages);
    // The last four bytes say that no page follows.
    for length in 0..whole.len() {
        assert!(read(Cursor::new(&whole[..length]), &ReadLimits::default()).is_err(), "{length}");
    }
}

#[test]
fn bits_are_numbers_and_rows_begin_with_a_byte() {
    for (bits, data, wanted) in [
        (1, &[0b1010_0000, 0b0110_0000][..], vec![1, 0, 1, 0, 1, 1]),
        (2, &[0b11_01_00_00, 0b10_00_01_00], vec![3, 1, 0, 2, 0, 1]),
        (4, &[0x1f, 0x20, 0x34, 0x50], vec![1, 15, 2, 3, 4, 5]),
    ] {
        let loaded = read_pages(&[page(3, 2, bits, data)]);
        assert_eq!(*loaded.volume.samples(), Samples::U8(wanted), "{bits} bits");
    }
    let loaded = read_pages(&[page(2, 1, 12, &[0x12, 0x3a, 0xbc])]);
    assert_eq!(*loaded.volume.samples(), Samples::U16(vec![0x123, 0xabc]));
}

#[test]
fn fax_is_read_in_both_groups() {
    let bytes = |bits: &str| -> Vec<u8> {
        let bits: Vec<u8> = bits.bytes().filter(u8::is_ascii_digit).map(|c| c - b'0').collect();
        bits.chunks(8).map(|byte| (0..8).fold(0, |sum, i| sum << 1 | byte.get(i).unwrap_or(&0))).collect()
    };
    // Three rows of four pixels: white; white, black, white, white; the same again.
    // Group 4: as above | horizontal: white 1, black 1, then as above | as above, three times.
    let group_4 = bytes("1 | 001 000111 010 1 | 1 1 1");
    // Group 3: an end of line, and white 4 | white 1, black 1, white 2 | the same.
    let (end, row) = ("000000000001", "000111 010 0111");
    let group_3 = bytes(&format!("{end} 1011 {end} {row} {end} {row}"));
    for (method, data) in [(3, &group_3[..]), (4, &group_4[..])] {
        let mut entries = page(4, 3, 1, data);
        entries.push(short(259, method));
        let loaded = read_pages(&[entries.clone()]);
        let wanted = vec![0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0];
        assert_eq!(*loaded.volume.samples(), Samples::U8(wanted), "method {method}");
        entries[4] = (273, 0, data[..1].to_vec());
        assert!(refused(&[entries.clone()]).contains("is no fax"));
        // Gigabytes of white in a few bytes.
        entries[0] = (256, 4, 2_013_265_921u32.to_le_bytes().to_vec());
        assert!(refused(&[entries]).contains("a row of 2013265921 pixels is too wide for fax"));
    }
}

#[test]
fn values_are_as_stored_whatever_is_white() {
    let mut entries = page(2, 1, 8, &[0, 255]);
    entries[3] = short(262, 0);
    let loaded = read_pages(&[entries]);
    assert_eq!(*loaded.volume.samples(), Samples::U8(vec![0, 255]));
    assert!(loaded.notes[0].contains("white is stored as 0"), "{:?}", loaded.notes);
}

#[test]
fn colours_planes_and_pages_of_other_sizes() {
    let rgb = |data: &[u8]| {
        let mut entries = page(1, 2, 8, data);
        entries[3] = short(262, 2);
        entries.push(short(277, 3));
        entries
    };
    let loaded = read_pages(&[rgb(&[1, 2, 3, 4, 5, 6])]);
    assert_eq!((loaded.volume.channels(), loaded.channels), (3, ChannelKind::Colours));
    let mut planar = rgb(&[1, 2]);
    planar.push(short(284, 2));
    assert!(refused(&[planar]).contains("needs 3 strips"));
    let small = page(1, 1, 8, &[9]);
    let loaded = read_pages(&[small.clone(), page(2, 1, 8, &[1, 2]), page(2, 1, 8, &[3, 4])]);
    assert_eq!(*loaded.volume.samples(), Samples::U8(vec![1, 2, 3, 4]));
    assert!(
        loaded.notes[0].contains("left out: 1 page of 1 x 1 pixels of 1 x 8 bits; read: 2 pages"),
        "{:?}",
        loaded.notes
    );
    let mut reduced = small;
    reduced.push((254, 4, 1u32.to_le_bytes().to_vec()));
    let loaded = read_pages(&[page(2, 1, 8, &[1, 2]), reduced]);
    assert!(loaded.notes[0].contains("1 reduced"), "{:?}", loaded.notes);
}

/// The pages 1, 2, 3, ... of one pixel each, with this description.
fn described(description: &str, count: u8, more: &[(u16, u16, Vec<u8>)]) -> Vec<Entries<'static>> {
    let mut pages: Vec<Entries> = (1..=count).map(|i| page(1, 1, 8, &[i])).collect();
    pages[0].push(text(description));
    pages[0].extend_from_slice(more);
    pages
}

#[test]
fn imagej_says_spacing_unit_and_the_order_of_pages() {
    let resolution = [fraction(282, 4, 1), fraction(283, 2, 1), short(296, 1)];
    let description = "ImageJ=1.53t\nimages=6\nchannels=2\nslices=3\nhyperstack=true\nspacing=2.5\nunit=\\u00B5m\nloop=false";
    let loaded = read_pages(&described(description, 6, &resolution));
    let volume = &loaded.volume;
    assert_eq!((volume.dims(), volume.channels(), loaded.channels), ([1, 1, 3], 2, ChannelKind::Volumes));
    assert_eq!(*volume.channel(1).samples(), Samples::U8(vec![2, 4, 6]));
    assert_eq!(volume.affine().spacing(), [0.25, 0.5, 2.5]);
    assert_eq!(loaded.world.unit.as_deref(), Some("um"));
    assert!(loaded.placed_by.contains("ImageJ's spacing") && loaded.notes.is_empty());
    // Frames of one layer are a stack that was not told so; many channels too.
    for (axis, layers, notes) in [("frames", 3, 1), ("channels", 1, 0), ("slices", 3, 0)] {
        let loaded = read_pages(&described(&format!("ImageJ=1\nimages=3\n{axis}=3\n"), 3, &[]));
        assert_eq!((loaded.volume.dims()[2], loaded.notes.len()), (layers, notes), "{axis}");
    }
    let loaded = read_pages(&described("ImageJ=1\nimages=9\nchannels=9\n", 9, &[]));
    assert_eq!(loaded.volume.dims()[2], 9);
    let loaded = read_pages(&described("ImageJ=1\nimages=9\nslices=9\n", 3, &resolution));
    assert_eq!((loaded.volume.dims()[2], loaded.notes.len()), (3, 2), "{:?}", loaded.notes);
}

#[test]
fn images_without_a_directory_are_read_too() {
    for description in ["ImageJ=1\nimages=3\nslices=3\n", "{\"shape\": [3, 1, 2], \"truncated\": true}"] {
        let mut entries = page(2, 1, 8, &[1, 2, 3, 4, 5, 6]);
        entries.push(text(description));
        let loaded = read_pages(&[entries.clone()]);
        assert_eq!(loaded.volume.dims(), [2, 1, 3]);
        assert_eq!(*loaded.volume.samples(), Samples::U8((1..=6).collect()));
        assert!(loaded.notes[0].contains("with one directory"), "{:?}", loaded.notes);
    }
    let mut entries = page(500, 1, 8, &[0; 1000]);
    entries.push(text("ImageJ=1\nimages=3\nslices=3\n"));
    assert!(refused(&[entries]).contains("too short"));
}

#[test]
fn ome_says_sizes_with_units_and_which_page_is_which() {
    let ome = |pixels: &str, data: &str| {
        format!(
            "<?xml version=\"1.0\"?><OME UUID=\"urn:uuid:1\"><Image ID=\"Image:0\"><Pixels DimensionOrder=\"XYCZT\" \
             SizeX=\"1\" SizeY=\"1\" SizeC=\"2\" SizeZ=\"2\" SizeT=\"1\" {pixels}><Channel SamplesPerPixel=\"1\"/>{data}\
             </Pixels></Image></OME>"
        )
    };
    let sizes =
        "PhysicalSizeX=\"0.5\" PhysicalSizeY=\"0.25\" PhysicalSizeZ=\"2000\" PhysicalSizeZUnit=\"nm\"";
    let loaded = read_pages(&described(&ome(sizes, "<TiffData/>"), 4, &[]));
    assert_eq!(*loaded.volume.channel(0).samples(), Samples::U8(vec![1, 3]));
    let spacing = loaded.volume.affine().spacing();
    assert_eq!((spacing[0], spacing[1], (spacing[2] - 2.0).abs() < 1e-12), (0.5, 0.25, true));
    assert_eq!((loaded.world.unit.as_deref(), &loaded.placed_by[..]), (Some("um"), "OME's PhysicalSize"));
    // Each plane has its own page, in the opposite order.
    let own = |i: usize, c: usize, z: usize| {
        format!(
            "<TiffData IFD=\"{i}\" FirstC=\"{c}\" FirstZ=\"{z}\"><UUID FileName=\"a\">urn:uuid:1</UUID></TiffData>"
        )
    };
    let data = [own(3, 0, 0), own(2, 1, 0), own(1, 0, 1), own(0, 1, 1)].concat();
    let loaded = read_pages(&described(&ome("", &data), 4, &[]));
    assert_eq!(*loaded.volume.channel(0).samples(), Samples::U8(vec![4, 2]));
    assert!(loaded.placed_by.contains("nothing"));
    let missing = refused(&described(&ome("", &own(0, 0, 0)), 4, &[]));
    assert!(missing.contains("3 of them are in no page"), "{missing}");
    let elsewhere = refused(&described(&ome("", &data.replacen(">urn:uuid:1<", ">urn:uuid:2<", 1)), 4, &[]));
    assert!(elsewhere.contains("in a; export a single"), "{elsewhere}");
}

#[test]
fn resolution_has_a_unit_or_is_a_ratio() {
    for (x, y, kind, wanted, unit, by) in [
        (254, 127, 2, [0.1, 0.2, 0.1], Some("mm"), "the resolution"),
        (100, 50, 3, [0.1, 0.2, 0.1], Some("mm"), "the resolution"),
        (2, 1, 1, [1.0, 2.0, 1.0], None, "the ratio of the resolutions"),
        (72, 72, 1, [1.0, 1.0, 1.0], None, "nothing: voxels of size 1"),
        (0, 0, 2, [1.0, 1.0, 1.0], None, "nothing: voxels of size 1"),
    ] {
        let loaded =
            read_pages(&described("-", 2, &[fraction(282, x, 1), fraction(283, y, 1), short(296, kind)]));
        let spacing = loaded.volume.affine().spacing();
        assert!((0..3).all(|a| (spacing[a] - wanted[a]).abs() < 1e-12), "{spacing:?}");
        assert_eq!((loaded.world.unit.as_deref(), &loaded.placed_by[..]), (unit, by));
        assert_eq!(loaded.notes.len(), usize::from(!by.starts_with("nothing")), "{:?}", loaded.notes);
    }
}

#[test]
fn what_is_not_read_says_why() {
    let with = |more: (u16, u16, Vec<u8>)| {
        let mut entries = page(3, 2, 8, &[0; 6]);
        entries.retain(|e| e.0 != more.0);
        entries.push(more);
        refused(&[entries])
    };
    for (entry, says) in [
        (short(259, 7), "JPEG"),
        (short(259, 50000), "Zstandard"),
        (short(262, 6), "YCbCr"),
        (short(339, 6), "complex"),
        (short(317, 9), "predictor 9"),
        (short(258, 16), "promises 12 bytes of values, but there are 6"),
        (short(256, 0), "no width"),
        ((256, 4, 2_000_000u32.to_le_bytes().to_vec()), "promises 4000000 bytes"),
        ((256, 4, 200_000_000u32.to_le_bytes().to_vec()), "promises"),
    ] {
        let message = with(entry);
        assert!(message.contains(says), "{message}");
    }
    // Numbers that end within a byte.
    for predictor in [2, 3] {
        let mut entries = page(4, 1, 14, &[0; 7]);
        entries.push(short(317, predictor));
        assert!(refused(&[entries]).contains("of numbers of 14 bits"));
    }
    assert!(read(Cursor::new(b"GIF89a.."), &ReadLimits::default()).is_err());
    // A page that is its own successor.
    let mut bytes = file(&[page(1, 1, 8, &[0])]);
    let (end, first) = (bytes.len() - 4, bytes[4..8].to_vec());
    bytes[end..].copy_from_slice(&first);
    let error =
        read(Cursor::new(bytes), &ReadLimits::default()).unwrap_err().in_file("a.tif".as_ref()).to_string();
    assert!(error.contains("circle"), "{error}");
}

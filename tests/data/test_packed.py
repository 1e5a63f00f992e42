#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The packed form gives back what was put in, to the bit, and the C has it; what is wrong is refused by name."""
import json
import re
import struct
import unittest
import zlib

import packed
import unpack

ODD = [0.0, -0.0, 1.0, -1.0, 0.1, 5e-324, -2.2250738585072014e-308, 1.7976931348623157e308, 0.1, -0.1, 0.1, 0.0, 1.0,
       1 / 3, 0.30000000000000004, 0.1, 1.0, 1 / 3]


def bits(numbers):
    return struct.pack(f"<{len(numbers)}d", *numbers)


class Packed(unittest.TestCase):
    def read(self, data, name="iiwa"):
        class File:
            stem = name

            @staticmethod
            def read_bytes():
                return data

        return packed.unpack(File)

    def test_numbers_come_back_to_the_bit(self):
        different, codes = packed._codes(packed._bits(ODD))
        self.assertEqual(len(different), len(set(map(bits, ([x] for x in ODD)))) - 1)  # 0 is not among them
        doubles = struct.unpack(f"<{len(different)}d", struct.pack(f"<{len(different)}Q", *different))
        self.assertEqual(bits(packed._numbers(doubles, codes)), bits(ODD))

    def test_a_record_comes_back_to_the_bit(self):
        for name in "iiwa", "control_tree03":
            record = packed.unpack(packed.HERE / f"{name}.bin")
            again = self.read(packed.pack(packed.root(name), record), name)
            self.assertEqual(json.dumps(again), json.dumps(record))
            self.assertGreater(len(json.dumps(record)), 50000)

    def test_the_c_text_has_the_numbers(self):
        record = packed.unpack(packed.HERE / "iiwa.bin")
        text = unpack.c_model("iiwa")
        for key, x in record["states"][1].items():
            if isinstance(x, list) and len(x) > 6:
                array = re.search(rf"ref_iiwa_states1_{key}\[{len(x)}\] = {{([^}}]*)}}", text)
                if array:  # else it is another one's, which is the same
                    self.assertEqual(bits(list(map(float, array[1].split(",")))), bits(x), key)
        self.assertEqual([float(unpack.number(x)) for x in ODD], ODD)
        self.assertEqual(unpack.number(-0.0), "-0.0")

    def test_damage_is_an_error(self):
        data = (packed.HERE / "iiwa.bin").read_bytes()
        for damaged in data[:-100], data[:3000] + b"\0" + data[3001:]:
            with self.assertRaises(zlib.error):
                self.read(damaged)
        short = zlib.compress(zlib.decompress(data)[:-4])
        with self.assertRaisesRegex(ValueError, "bytes of numbers instead of"):
            self.read(short)

    def test_wrong_records_are_refused(self):
        def refused(change, message):
            record = packed.unpack(packed.HERE / "iiwa.bin")
            change(record)
            with self.assertRaisesRegex(ValueError, message):
                unpack.Text("iiwa").record("ref_model", "iiwa", record, {})

        refused(lambda r: r["states"][0]["q"].append(1.0), "iiwa_states0_q: 8 values instead of 7")
        refused(lambda r: r["states"][2].update(speed=[1.0]), "not in reference.h: speed")
        refused(lambda r: r["states"][2].pop("tau"), "no tau")


if __name__ == "__main__":
    unittest.main()

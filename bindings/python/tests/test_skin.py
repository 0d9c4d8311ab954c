"""Skin by what it is made of."""
import unittest

import numpy as np

import pellucid


class Skin(unittest.TestCase):
    def test_a_profile_and_its_numbers(self):
        skin = pellucid.Skin(melanin=0.1, blood=0.02)
        info, darker = pellucid.skin_info(skin), pellucid.skin_info(skin, melanin=0.2)
        self.assertTrue((darker.albedo < info.albedo).all())
        self.assertEqual(skin.melanin, np.float32(0.1))
        profile = pellucid.Profile.skin_layers(skin, name="brown")
        self.assertEqual((profile.info.kind, profile.info.name), (pellucid.ProfileKind.SKIN_LAYERS, "brown"))
        at = np.arange(380, 721, 5)
        self.assertTrue((pellucid.skin_reflectance(at, darker_skin := skin.copy(), melanin=0.2)
                         < pellucid.skin_reflectance(at, darker_skin)).all())

    def test_bad_values_are_refused_by_name(self):
        for field, value in (("melanin", 0.6), ("blood", -0.1), ("epidermis", 0), ("oxygenation", np.nan)):
            with self.assertRaisesRegex((pellucid.PellucidError, ValueError), field):
                pellucid.skin_info(**{field: value})

    def test_maps_and_back(self):
        melanin, blood = np.meshgrid(np.linspace(0, 0.4, 9), np.linspace(0.001, 0.15, 7))
        albedo, radius = pellucid.skin_albedo(melanin, blood)
        self.assertEqual((albedo.shape, radius.shape), ((7, 9, 3), (7, 9)))
        self.assertTrue((np.diff(radius, axis=1) < 0).all())
        m, b, difference = pellucid.skin_from_albedo(albedo)
        self.assertLess(difference.max(), 0.5)
        np.testing.assert_allclose(m, melanin, atol=0.005)
        np.testing.assert_allclose(b, blood, atol=0.005)
        twice = pellucid.skin_from_albedo(np.concatenate([albedo, albedo[::-1]]))
        np.testing.assert_array_equal(twice[0], np.concatenate([m, m[::-1]]))
        one = pellucid.skin_from_albedo(albedo[3, 4])  # a single colour
        np.testing.assert_array_equal(one, (m[3, 4], b[3, 4], difference[3, 4]))
        with self.assertRaisesRegex(ValueError, "albedo has the shape"):
            pellucid.skin_from_albedo(np.zeros((2, 2)))


if __name__ == "__main__":
    unittest.main()

"""The panel in the sidebar of the 3D view, tab Pellucid."""

import bpy

from . import render
from .fields import FIELDS


class PELLUCID_PT_panel(bpy.types.Panel):
    bl_label, bl_idname = "Pellucid", "PELLUCID_PT_panel"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Pellucid"

    def draw(self, context):
        layout, settings = self.layout, context.scene.pellucid
        layout.use_property_split = True
        row = layout.row()
        row.scale_y = 1.5
        row.operator("pellucid.render", text=render.status or "Render", icon="RENDER_STILL")
        column = layout.column()
        for name in ("samples", "exposure", "shadow_size", "unit"):
            column.prop(settings, name)


class PELLUCID_PT_materials(bpy.types.Panel):
    """Those of the selected objects, or all that are in use."""

    bl_label, bl_idname, bl_parent_id = "Materials", "PELLUCID_PT_materials", "PELLUCID_PT_panel"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Pellucid"

    def draw(self, context):
        things = [t for t in context.selected_objects
                  if t.type == "MESH"] or [t for t in context.scene.objects if t.type == "MESH"]
        materials = sorted({slot.material for t in things for slot in t.material_slots if slot.material},
                           key=lambda m: m.name)
        for material in materials:
            row = self.layout.row(align=True)
            row.label(text=material.name, icon_value=material.preview.icon_id if material.preview else 0)
            row.prop(material, "pellucid", text="")
            add = row.operator_menu_enum("pellucid.own_value", "field", text="", icon="ADD")
            add.material = material.name
            for name, field in FIELDS.items():
                if name in material:
                    row = self.layout.row(align=True)
                    row.prop(material, f'["{name}"]', text=field[0])
                    remove = row.operator("pellucid.own_value", text="", icon="X")
                    remove.material, remove.field = material.name, name
        if not materials:
            self.layout.label(text="No materials: everything is skin")


register, unregister = bpy.utils.register_classes_factory((PELLUCID_PT_panel, PELLUCID_PT_materials))

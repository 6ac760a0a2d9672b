!> Heights of the contact surfaces of shells above the faces of the mesh, by SURFACE PROPERTY ASSIGNMENT: thickness and place.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A shell of thickness t, whose nodes lie at a t from its middle along the normal, has its faces at t (1/2 - a) (SPOS) and
!! t (1/2 + a) (SNEG) from the nodes. The mesh has those of the section; contact sees those of the assignment, which lie higher by
!! the difference. Pairs shift their gap by it: a parallel surface has the same normals. Cost: linear in faces and assignments.
module amontons_contact_heights
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_exterior_surface, only: exterior_type
  use amontons_deck_structure, only: is_shell, structural_face
  implicit none
  private
  public :: assign_heights

contains

  !> Assigns the heights. Of several assignments of a face the last one counts.
  subroutine assign_heights(model, exterior)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(inout) :: exterior !< its heights
    real(DP) :: thickness(exterior%n), place(exterior%n)   !< assigned
    logical :: is_in(exterior%n)
    integer :: k, f
    if (.not. (allocated(model%general_contact) .and. allocated(model%structure))) return
    if (.not. allocated(model%general_contact%properties)) return
    if (size(model%general_contact%properties) == 0) return
    thickness = [(section_thickness(f), f=1, exterior%n)]
    place = [(section_place(f), f=1, exterior%n)]
    do k = 1, size(model%general_contact%properties)
      associate (property => model%general_contact%properties(k))
        call mark_faces(property%surface)
        do f = 1, exterior%n
          if (.not. is_in(f)) cycle
          if (property%is_place) then
            place(f) = merge(section_place(f), property%value, property%is_original)
          else
            thickness(f) = merge(section_thickness(f), property%value, property%is_original) * property%factor
          end if
        end do
      end associate
    end do
    do f = 1, exterior%n
      exterior%height(f) = face_distance(thickness(f), place(f), side_of(f)) - face_distance(section_thickness(f), &
        section_place(f), side_of(f))
    end do

  contains

    !> Marks the faces of a surface; 0: the whole exterior.
    subroutine mark_faces(surface)
      integer, intent(in) :: surface               !< index
      logical :: is_member(6, model%mesh%n_elements)
      integer :: i
      is_in = surface == 0
      if (surface == 0) return
      is_member = .false.
      associate (faces => model%surfaces(surface))
        do i = 1, size(faces%element)
          is_member(faces%face(i), faces%element(i)) = .true.
        end do
      end associate
      is_in = [(is_member(exterior%face(i), exterior%element(i)), i=1, exterior%n)]
    end subroutine mark_faces

    !> The side of a shell that a face is: 1 SPOS, -1 SNEG, 0 an edge or no shell.
    pure integer function side_of(f) result(side)
      integer, intent(in) :: f                     !< face
      side = 0
      associate (e => exterior%element(f))
        if (.not. is_shell(model, e)) return
        if (exterior%face(f) == structural_face(model, e, 'SPOS')) side = 1
        if (exterior%face(f) == structural_face(model, e, 'SNEG')) side = -1
      end associate
    end function side_of

    !> The thickness of the section below a face; 0: no shell [length].
    pure real(DP) function section_thickness(f) result(thickness)
      integer, intent(in) :: f                     !< face
      thickness = 0.0_DP
      if (side_of(f) /= 0) thickness = model%structure%sections(model%structure%section(exterior%element(f)))%thickness(1)
    end function section_thickness

    !> The position of the nodes in the section below a face, over its thickness from its middle [-].
    pure real(DP) function section_place(f) result(place)
      integer, intent(in) :: f                     !< face
      place = 0.0_DP
      if (side_of(f) /= 0) place = model%structure%sections(model%structure%section(exterior%element(f)))%offset(1)
    end function section_place

  end subroutine assign_heights


  !> How far a face of a shell lies from its nodes, outward [length].
  elemental real(DP) function face_distance(thickness, place, side) result(distance)
    real(DP), intent(in) :: thickness              !< [length]
    real(DP), intent(in) :: place                  !< of the nodes over the thickness, from its middle along the normal [-]
    integer, intent(in) :: side                    !< 1 SPOS, -1 SNEG, 0 no face of a shell
    distance = thickness * (0.5_DP * real(abs(side), DP) - real(side, DP) * place)
  end function face_distance

end module amontons_contact_heights

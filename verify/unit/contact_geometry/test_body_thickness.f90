!> Unit test of body_thickness: layers of elements, an inclined side, bodies that overlap, a face that nothing opposes.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_body_thickness
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_exterior_surface, only: exterior_type, build_exterior
  use amontons_body_thickness, only: measure_body_thickness
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  real(DP), parameter :: TOL = 1.0e-12_DP          !< sums of a few terms
  type(suite_type) :: suite
  call check_layers()
  call check_wedge()
  call suite%finish()

contains

  !> Two layers of 0.25 and 0.75, and another block that overlaps the upper one: 1 through both layers, and each body alone counts.
  subroutine check_layers()
    type(model_type) :: model
    type(exterior_type) :: exterior
    real(DP), allocatable :: thickness(:)
    call read_exterior('*NODE;1,0,0,0;2,2,0,0;3,2,2,0;4,0,2,0;5,0,0,.25;6,2,0,.25;7,2,2,.25;8,0,2,.25;9,0,0,1;10,2,0,1;' // &
      '11,2,2,1;12,0,2,1;21,0,0,.9;22,2,0,.9;23,2,2,.9;24,0,2,.9;25,0,0,3.9;26,2,0,3.9;27,2,2,3.9;28,0,2,3.9;' // &
      '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;2,5,6,7,8,9,10,11,12;3,21,22,23,24,25,26,27,28;', model, exterior)
    call measure_body_thickness(model%mesh, exterior, 10.0_DP, thickness)
    call suite%near('layers from below', thickness_at(exterior, thickness, 1, 3, -1), 1.0_DP, TOL)
    call suite%near('layers from above', thickness_at(exterior, thickness, 2, 3, 1), 1.0_DP, TOL)
    call suite%near('layers from the side', thickness_at(exterior, thickness, 1, 1, 1), 2.0_DP, TOL)
    call suite%near('the other block', thickness_at(exterior, thickness, 3, 3, -1), 3.0_DP, TOL)
    call measure_body_thickness(model%mesh, exterior, 1.5_DP, thickness)
    call suite%that('beyond the reach', thickness_at(exterior, thickness, 3, 3, -1) > 2.9_DP)
  end subroutine check_layers


  !> A wedge in the plane: the inclined side opposes the flat one, and the long end at half of its height.
  subroutine check_wedge()
    type(model_type) :: model
    type(exterior_type) :: exterior
    real(DP), allocatable :: thickness(:)
    call read_exterior('*NODE;1,0,0;2,2,0;3,2,1.5;4,0,.5;*ELEMENT, TYPE=CPE4, ELSET=E;1,1,2,3,4;', model, exterior)
    call measure_body_thickness(model%mesh, exterior, 10.0_DP, thickness)
    call suite%near('below the flat side', thickness_at(exterior, thickness, 1, 2, -1), 1.0_DP, TOL)
    call suite%near('from the long end', thickness_at(exterior, thickness, 1, 1, 1), 1.5_DP, TOL)
    call suite%near('from the short end', thickness_at(exterior, thickness, 1, 1, -1), 2.0_DP, TOL)
  end subroutine check_wedge


  !> The thickness below the face of an element whose normal is along an axis [length].
  pure real(DP) function thickness_at(exterior, thickness, element, axis, side)
    type(exterior_type), intent(in) :: exterior
    real(DP), intent(in) :: thickness(:)           !< [length]
    integer, intent(in) :: element, axis
    integer, intent(in) :: side                    !< 1 or -1
    integer :: f
    thickness_at = -1.0_DP
    do f = 1, exterior%n
      if (exterior%element(f) == element .and. real(side, DP) * exterior%normal(axis, f) > 0.999_DP) thickness_at = thickness(f)
    end do
  end function thickness_at


  !> Reads nodes and elements, and finds their exterior.
  subroutine read_exterior(mesh_cards, model, exterior)
    character(*), intent(in) :: mesh_cards
    type(model_type), intent(out) :: model
    type(exterior_type), intent(out) :: exterior
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    integer :: no_pairs(2, 0)
    call read_deck_text(deck_lines(mesh_cards // '*MATERIAL, NAME=A;*ELASTIC;4000., 0.3;*SOLID SECTION, ELSET=E, MATERIAL=A;' // &
      '*STEP;*STATIC;*END STEP;'), options, model, diagnostics, error)
    call suite%that('deck', .not. allocated(error))
    call build_exterior(model%mesh, spread(.false., 1, model%mesh%n_elements), no_pairs, exterior)
  end subroutine read_exterior

end program test_body_thickness

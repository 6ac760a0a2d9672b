!> Unit test of contact_heights: thickness and place of a plate of thickness 0.2 whose nodes lie at its bottom or in its middle.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_heights
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, absent_elements
  use amontons_exterior_surface, only: exterior_type, build_exterior
  use amontons_contact_heights, only: assign_heights
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: NODES = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;*ELEMENT, TYPE=S4, ELSET=E;1,1,2,3,4;' // &
    '*MATERIAL, NAME=A;*ELASTIC;4000., 0.3;*SHELL SECTION, ELSET=E, MATERIAL=A'
  character(*), parameter :: REST = ';0.2;*SURFACE, NAME=TOP;E, SPOS;*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;'
  character(*), parameter :: THICK = '*SURFACE PROPERTY ASSIGNMENT, PROPERTY=THICKNESS;', &
    PLACE = '*SURFACE PROPERTY ASSIGNMENT, PROPERTY=OFFSET FRACTION;'
  real(DP), parameter :: TOL = 1.0e-14_DP          !< rounding of a few terms
  type(suite_type) :: suite
  call check('none', '', '', [0.0_DP, 0.0_DP])
  call check('original', '', THICK // ',ORIGINAL;' // PLACE // ',ORIGINAL;', [0.0_DP, 0.0_DP])
  call check('thickness', '', THICK // ',0.5;', [0.15_DP, 0.15_DP])
  call check('factor', '', THICK // ',THINNING,0.5;', [-0.05_DP, -0.05_DP])
  call check('thickness and factor', '', THICK // ',0.5,0.5;', [0.025_DP, 0.025_DP])
  call check('a side', '', THICK // 'TOP,0.5;', [0.0_DP, 0.15_DP])
  call check('the last one counts', '', THICK // ',0.5;TOP,ORIGINAL;', [0.15_DP, 0.0_DP])
  call check('nodes on top', '', PLACE // ',SPOS;', [0.1_DP, -0.1_DP])
  call check('nodes at the bottom', '', PLACE // ',SNEG;', [-0.1_DP, 0.1_DP])
  call check('a quarter, and thick', '', PLACE // ',0.25;' // THICK // ',0.4;', [0.2_DP, 0.0_DP])
  call check('section with nodes on top', ', OFFSET=SPOS', THICK // ',0.5;', [0.3_DP, 0.0_DP])
  call check('back to the middle', ', OFFSET=SPOS', PLACE // ',0.;', [-0.1_DP, 0.1_DP])
  call suite%finish()

contains

  !> The heights of bottom and top face; those of the edges are zero.
  subroutine check(name, offset, assignments, expected)
    character(*), intent(in) :: name, offset, assignments
    real(DP), intent(in) :: expected(2)            !< SNEG, SPOS [length]
    type(model_type) :: model
    type(exterior_type) :: exterior
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    integer :: no_node_pairs(2, 0), f
    real(DP) :: height
    call read_deck_text(deck_lines(NODES // offset // REST // assignments // '*STEP;*STATIC;*END STEP;'), options, model, &
      diagnostics, error)
    call suite%that('deck: ' // name, .not. allocated(error))
    if (allocated(error)) return
    call build_exterior(model%mesh, absent_elements(model, 1), no_node_pairs, exterior)
    call assign_heights(model, exterior)
    call suite%that('six faces: ' // name, exterior%n == 6)
    do f = 1, exterior%n
      height = 0.0_DP
      if (exterior%face(f) < 3) height = expected(exterior%face(f))
      call suite%near(name, exterior%height(f), height, TOL)
    end do
  end subroutine check

end program test_contact_heights

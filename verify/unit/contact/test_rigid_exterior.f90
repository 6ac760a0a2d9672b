!> Unit test of rigid_exterior: the rigid body of a node, whether supports drive it, and which sides of sheets face each other.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_rigid_exterior
  use amontons_kinds, only: DP, PI
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, free_unknowns, job_options_type
  use amontons_text, only: NEWLINE
  use amontons_rigid_exterior, only: rigid_bodies_type, collect_rigid_bodies, is_pair_driven, is_one_body, &
    unpaired_edges_warning, compare_sheets, SHEETS_FACE, SHEETS_BEHIND, SHEETS_UNDECIDED
  use check, only: suite_type
  implicit none
  character(*), parameter :: CUBES = '*NODE;1, 0, 0, 0;2, 1, 0, 0;3, 1, 1, 0;4, 0, 1, 0;5, 0, 0, 1;6, 1, 0, 1;7, 1, 1, 1;' // &
    '8, 0, 1, 1;11, 0, 0, 2;12, 1, 0, 2;13, 1, 1, 2;14, 0, 1, 2;15, 0, 0, 3;16, 1, 0, 3;17, 1, 1, 3;18, 0, 1, 3;90, 0, 0, 0;' // &
    '91, 0, 0, 2;*ELEMENT, TYPE=C3D8, ELSET=LOW;1, 1, 2, 3, 4, 5, 6, 7, 8;*ELEMENT, TYPE=C3D8, ELSET=UP;' // &
    '2, 11, 12, 13, 14, 15, 16, 17, 18;*ELSET, ELSET=ALL;LOW, UP;*MATERIAL, NAME=A;*ELASTIC;4000., 0.3;' // &
    '*SOLID SECTION, ELSET=ALL, MATERIAL=A;'
  character(*), parameter :: SQUARES = '*NODE;1, 0, 0;2, 1, 0;3, 1, 1;4, 0, 1;11, 0, 2;12, 1, 2;13, 1, 3;14, 0, 3;90, 0, 0;' // &
    '91, 0, 2;*ELEMENT, TYPE=CPE4, ELSET=LOW;1, 1, 2, 3, 4;*ELEMENT, TYPE=CPE4, ELSET=UP;2, 11, 12, 13, 14;*ELSET, ELSET=ALL;' // &
    'LOW, UP;*MATERIAL, NAME=A;*ELASTIC;4000., 0.3;*SOLID SECTION, ELSET=ALL, MATERIAL=A;'
  character(*), parameter :: BODIES = '*RIGID BODY, ELSET=LOW, REF NODE=90;*RIGID BODY, ELSET=UP, REF NODE=91;'
  type(suite_type) :: suite
  type(model_type) :: model
  type(rigid_bodies_type) :: rigid
  integer :: low, up
  call check_solids()
  call check_planes()
  call check_couplings()
  call check_sheets()
  call suite%finish()

contains

  !> Six supports of the reference node in each step drive a body.
  subroutine check_solids()
    logical, allocatable :: is_free(:, :)
    call collect(CUBES // BODIES, '90, 1, 6', '91, 1, 2')
    call suite%that('one body', is_one_body(rigid, [low, low + 1]) .and. .not. is_one_body(rigid, [low, up]))
    call suite%that('the lower is driven, the upper not', rigid%is_driven(low) .and. .not. rigid%is_driven(up))
    call suite%that('they can move', .not. is_pair_driven(rigid, [low, up]) .and. is_pair_driven(rigid, [up, up + 1]))
    is_free = free_unknowns(model, 1)
    call suite%that('free unknowns', all(is_free(:, rigid%reference(up)) .eqv. [.false., .false., .true.]) .and. &
      .not. any(is_free(:, rigid%reference(low))))
    call collect(CUBES // BODIES, '90, 1, 6', '91, 1, 6')
    call suite%that('both driven', is_pair_driven(rigid, [low, up]))
    call collect(CUBES // BODIES, '90, 1, 5', '91, 1, 6')
    call suite%that('a rotation is free', .not. rigid%is_driven(low) .and. rigid%is_driven(up))
  end subroutine check_solids


  !> In the plane three supports do.
  subroutine check_planes()
    call collect(SQUARES // BODIES, '90, 1, 2;90, 6', '91, 1, 2')
    call suite%that('three supports, and two', rigid%is_driven(low) .and. .not. rigid%is_driven(up))
  end subroutine check_planes


  !> Two squares of edge 1: parallel, touching along an edge, in one plane, crossing.
  subroutine check_sheets()
    call suite%that('above', order(1.0_DP, 0.0_DP, 0.1_DP) == SHEETS_FACE)
    call suite%that('far sides', order(-1.0_DP, 0.0_DP, 0.1_DP) == SHEETS_BEHIND)
    call suite%that('in one plane', order(1.0_DP, 0.0_DP, 1.0e-6_DP) == SHEETS_UNDECIDED)
    call suite%that('on its edge', order(1.0_DP, PI / 3, 0.5_DP * sin(PI / 3)) == SHEETS_FACE)
    call suite%that('far sides on an edge', order(-1.0_DP, PI / 3, 0.5_DP * sin(PI / 3)) == SHEETS_BEHIND)
    call suite%that('crossing', order(1.0_DP, PI / 3, 0.3_DP) == SHEETS_UNDECIDED .and. order(-1.0_DP, PI / 3, 0.3_DP) == &
      SHEETS_UNDECIDED)
  end subroutine check_sheets


  !> The order of a square about the origin and one above it, turned about the y axis, whose normals oppose.
  integer function order(side, angle, height)
    real(DP), intent(in) :: side                   !< 1: the sides that face each other, -1: the others
    real(DP), intent(in) :: angle, height          !< of the second one [rad], [length]
    real(DP), parameter :: TOL = 2.0e-6_DP         !< two depths of a millionth [length]
    real(DP), parameter :: X(4) = [-0.5_DP, 0.5_DP, 0.5_DP, -0.5_DP], Y(4) = [-0.5_DP, -0.5_DP, 0.5_DP, 0.5_DP]
    real(DP) :: low(3, 4), high(3, 4), normals(3, 2)
    low = transpose(reshape([X, Y, 0 * X], [4, 3]))
    high = transpose(reshape([X * cos(angle), Y, height + X * sin(angle)], [4, 3]))
    normals = side * reshape([0.0_DP, 0.0_DP, 1.0_DP, sin(angle), 0.0_DP, -cos(angle)], [3, 2])
    order = compare_sheets(low, high, normals, TOL)
  end function order


  !> A coupling of two directions leaves its nodes a third; a model without rigid bodies has none.
  subroutine check_couplings()
    call collect(CUBES // '*SURFACE, NAME=S;UP, S2;*COUPLING, REF NODE=91, SURFACE=S, CONSTRAINT NAME=C;*KINEMATIC;1, 2;', &
      '90, 1, 3', '91, 1, 3')
    call suite%that('of no whole body', .not. any(rigid%is_whole) .and. .not. any(rigid%is_driven))
    call collect(CUBES, '90, 1, 3', '91, 1, 3')
    call suite%that('no rigid edge', unpaired_edges_warning(model) == '')
    call suite%that('none', .not. any(rigid%is_driven) .and. all(rigid%reference == 0))
  end subroutine check_couplings


  !> The rigid bodies of a deck with supports at the reference nodes; low and up are a node of each body.
  subroutine collect(cards, lower, upper)
    character(*), intent(in) :: cards, lower, upper
    type(diagnostic_list_type) :: complaints
    type(job_options_type) :: options
    type(error_type), allocatable :: error
    character(:), allocatable :: text
    integer :: i
    text = cards // '*STEP;*STATIC;*BOUNDARY;' // lower // ';' // upper // ';*END STEP;'
    do i = 1, len(text)
      if (text(i:i) == ';') text(i:i) = NEWLINE
    end do
    options%job = 'unit'
    call read_deck_text(text, options, model, complaints, error)
    call suite%that('the deck is read', .not. allocated(error))
    if (allocated(error)) return
    low = findloc(model%mesh%node_label, 1, dim=1)
    up = findloc(model%mesh%node_label, 11, dim=1)
    call collect_rigid_bodies(model, rigid)
  end subroutine collect

end program test_rigid_exterior

!> Unit test of amontons_directors: normals of known surfaces, smooth and sharp edges, NORMAL, axes of beams.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_directors
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_directors, only: find_element_normals
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;*MATERIAL, NAME=M;*ELASTIC;100.,0.3;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call check_normals()
  call check_edges()
  call check_given_normals()
  call check_beams()
  call suite%finish()

contains

  !> Plane elements, and quadratic ones on z = x^2 / 2: normal (-x, 0, 1).
  subroutine check_normals()
    real(DP), parameter :: QUAD(2, 8) = reshape([real(DP) :: 0, 0, 1, 0, 1, 1, 0, 1, 0.5_DP, 0, 1, 0.5_DP, 0.5_DP, 1, 0, 0.5_DP], &
      [2, 8])
    real(DP), parameter :: TRIANGLE(2, 6) = reshape([real(DP) :: 0, 0, 1, 0, 0, 1, 0.5_DP, 0, 0.5_DP, 0.5_DP, 0, 0.5_DP], [2, 6])
    call check_surface('quad4', QUAD(:, :4), 0.0_DP)
    call check_surface('quad8', QUAD, 1.0_DP)
    call check_surface('tri3', TRIANGLE(:, :3), 0.0_DP)
    call check_surface('tri6', TRIANGLE, 1.0_DP)
    call check_surface('no area', 0 * TRIANGLE, -1.0_DP)
  end subroutine check_normals


  !> One element on z = c x^2 / 2; c < 0: it has no normal.
  subroutine check_surface(name, flat, c)
    character(*), intent(in) :: name
    real(DP), intent(in) :: flat(:, :), c
    real(DP) :: x(3, size(flat, 2)), normals(3, size(flat, 2)), expected(3)
    integer :: a
    x(:2, :) = flat
    x(3, :) = 0.5_DP * max(0.0_DP, c) * flat(1, :)**2
    call find_element_normals(x, normals)
    do a = 1, size(flat, 2)
      expected = [-c * flat(1, a), 0.0_DP, 1.0_DP] / sqrt(1 + (c * flat(1, a))**2)
      if (c < 0) expected = 0
      call suite%near(name, norm2(normals(:, a) - expected), 0.0_DP, 1.0e-15_DP)
    end do
  end subroutine check_surface


  !> Two plates that meet at an angle: below 20 degrees one mean normal, above it two; other thickness, two.
  subroutine check_edges()
    type(model_type) :: model
    real(DP), parameter :: PI = acos(-1.0_DP)
    call expect_read(plates(10) // '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;', model)
    call suite%that('smooth', size(model%structure%directors) == 6)
    call suite%near('mean normal', norm2(model%structure%directors(2)%axes(:, 1) - [-sin(PI / 36), 0.0_DP, cos(PI / 36)]), 0.0_DP, &
      1.0e-12_DP)
    call expect_read(plates(10) // '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;*BOUNDARY;2,XSYMM;', model)
    call suite%near('symmetry plane', norm2(model%structure%directors(2)%axes(:, 1) - [0.0_DP, 0.0_DP, 1.0_DP]), 0.0_DP, 1.0e-15_DP)
    call expect_read(plates(10) // '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;*BOUNDARY;2,ENCASTRE;', model)
    call suite%near('clamped', model%structure%directors(2)%axes(1, 1), -sin(PI / 36), 1.0e-12_DP)
    call expect_read(plates(30) // '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;', model)
    call suite%that('sharp', size(model%structure%directors) == 8)
    call suite%that('order of the nodes', all(model%structure%directors%node == [1, 2, 2, 3, 3, 4, 5, 6]))
    call expect_read(plates(0) // '*ELSET, ELSET=A;1;*ELSET, ELSET=B;2;*SHELL SECTION, ELSET=A, MATERIAL=M;.1;' // &
      '*SHELL SECTION, ELSET=B, MATERIAL=M;.2;', model)
    call suite%that('other thickness', size(model%structure%directors) == 8)
    call expect_read(rigid(plates(90)), model)
    call suite%that('rigid elements share it over a right angle', size(model%structure%directors) == 6)
    call expect_read(rigid(plates(100)), model)
    call suite%that('not beyond', size(model%structure%directors) == 8)
  end subroutine check_edges


  !> The cards of shells as those of rigid elements.
  function rigid(cards) result(changed)
    character(*), intent(in) :: cards
    character(:), allocatable :: changed
    integer :: i
    i = index(cards, 'TYPE=S4')
    changed = cards(:i + 4) // 'R3D4' // cards(i + 7:) // '*NODE;90,0,0,5;*RIGID BODY, ELSET=E, REF NODE=90;'
  end function rigid


  !> NORMAL of one element: it keeps it, and elements beyond half a degree keep theirs.
  subroutine check_given_normals()
    type(model_type) :: model
    call expect_read(plates(10) // '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;*NORMAL;1,2,0,0,2;', model)
    call suite%that('two at the node', size(model%structure%directors) == 7)
    call suite%near('as given', norm2(model%structure%directors(2)%axes(:, 1) - [0.0_DP, 0.0_DP, 1.0_DP]), 0.0_DP, 1.0e-15_DP)
  end subroutine check_given_normals


  !> A beam along x + y: direction 1 is the part of z normal to it, direction 2 tangent x direction 1.
  subroutine check_beams()
    type(model_type) :: model
    call expect_read('*ELEMENT, TYPE=B31, ELSET=B;9,1,3;*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;.1,.2;1,1,2;', model)
    associate (d => model%structure%directors(1))
      call suite%near('direction 1', norm2(d%axes(:, 1) - [0.0_DP, 0.0_DP, 1.0_DP]), 0.0_DP, 1.0e-15_DP)
      call suite%near('direction 2', norm2(d%axes(:, 2) - [1.0_DP, -1.0_DP, 0.0_DP] / sqrt(2.0_DP)), 0.0_DP, 1.0e-15_DP)
    end associate
    call expect_message('*ELEMENT, TYPE=B31, ELSET=B;9,1,3;*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;.1,.2;1,1,0;', &
      'has no normal')
  end subroutine check_beams


  !> Nodes and elements of two plates 1 x 1 at an angle in degrees.
  function plates(angle) result(text)
    integer, intent(in) :: angle
    character(:), allocatable :: text
    character(120) :: nodes
    real(DP) :: s, c
    s = sin(real(angle, DP) * acos(-1.0_DP) / 180)
    c = cos(real(angle, DP) * acos(-1.0_DP) / 180)
    write (nodes, '("*NODE;5,", f18.15, ",0,", f18.15, ";6,", f18.15, ",1,", f18.15, ";")') 1 + c, s, 1 + c, s
    text = trim(nodes) // '*ELEMENT, TYPE=S4, ELSET=E;1,1,2,3,4;2,2,5,6,3;'
  end function plates


  include 'sample_deck.inc'

end program test_directors

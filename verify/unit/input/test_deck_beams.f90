!> Unit test of deck_beams: dimensions of the cross-sections in both dialects, middle nodes, beams in the plane, what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_beams
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_element_kinds, only: KIND_BEAM_PIPE, KIND_BEAM_BOX, KIND_BEAM_CIRC, KIND_BEAM_KRONROD, KIND_C3D20
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=N;1,0,0,0;2,1,0,0;3,2,0,0;*MATERIAL, NAME=M;*ELASTIC;100.,0.3;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: B32 = '*ELEMENT, TYPE=B32R, ELSET=B;1,1,2,3;', B31 = '*ELEMENT, TYPE=B31, ELSET=B;1,1,2;2,2,3;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_dimensions()
  call check_middle_nodes()
  call check_plane_beams()
  call check_errors()
  call suite%finish()

contains

  !> The card of a section.
  pure function section(word, data) result(card)
    character(*), intent(in) :: word, data
    character(:), allocatable :: card
    card = '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=' // word // ';' // data // ';0,1,0;'
  end function section


  !> Circles: the radius, in CalculiX the diameters; pipes and boxes: walls over the dimensions.
  subroutine check_dimensions()
    call expect_read(B32 // section('CIRC', '.3'), model)
    call suite%near('radius', maxval(abs(model%structure%directors(1)%thickness - 0.6_DP)), 0.0_DP, 1.0e-15_DP)
    call suite%that('circle', model%mesh%kind(1) == KIND_BEAM_CIRC)
    call expect_read(B32 // section('CIRC', '.3,.4'), model, DIALECT_CALCULIX)
    call suite%near('diameters', maxval(abs(model%structure%directors(1)%thickness - [0.3_DP, 0.4_DP])), 0.0_DP, 1.0e-15_DP)
    associate (d => model%structure%directors(1), x => model%mesh%coordinates)
      call suite%near('a corner on the ellipse', norm2((x(2:, d%nodes(4)) - x(2:, d%node)) / d%thickness), 0.5_DP, 1.0e-15_DP)
    end associate
    call suite%that('calculix: 5 x 5 points of B32R', model%mesh%kind(1) == KIND_BEAM_KRONROD)
    call expect_read(B32 // section('RECT', '.3'), model, DIALECT_CALCULIX)
    call suite%near('calculix: a square', maxval(abs(model%structure%directors(1)%thickness - 0.3_DP)), 0.0_DP, 1.0e-15_DP)
    call expect_read('*ELEMENT, TYPE=B32, ELSET=B;1,1,2,3;' // section('RECT', '.3,.4'), model, DIALECT_CALCULIX)
    call suite%that('three along B32', model%mesh%kind(1) == KIND_C3D20)
    call expect_read(B32 // section('PIPE', '.3,.06'), model)
    call suite%that('pipe', model%mesh%kind(1) == KIND_BEAM_PIPE)
    call suite%near('wall of a pipe', model%mesh%walls(1, 1), 0.1_DP, 1.0e-15_DP)
    call expect_read(B32 // section('BOX', '1.,2.,.1,.2,.3,.4'), model, DIALECT_CALCULIX)
    call suite%that('box', model%mesh%kind(1) == KIND_BEAM_BOX)
    call suite%near('walls of a box', norm2(model%mesh%walls(:, 1) - [0.1_DP, 0.1_DP, 0.3_DP, 0.2_DP]), 0.0_DP, 1.0e-15_DP)
  end subroutine check_dimensions


  !> B31 gets a node in the middle, but not of RECT.
  subroutine check_middle_nodes()
    call expect_read(B31 // section('PIPE', '.3,.06'), model)
    call suite%that('one node for each element', model%structure%n_deck_nodes == 5)
    call suite%near('in the middle', norm2(model%mesh%coordinates(:, 5) - [1.5_DP, 0.0_DP, 0.0_DP]), 0.0_DP, 0.0_DP)
    call expect_read(B31 // section('RECT', '.3,.06'), model)
    call suite%that('none of RECT', model%structure%n_deck_nodes == 3)
  end subroutine check_middle_nodes


  !> Nodes of B21 are held out of the plane and turn about z alone.
  subroutine check_plane_beams()
    integer :: i, n
    call expect_read('*ELEMENT, TYPE=B21, ELSET=B;1,1,2;2,2,3;*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;.1,.2;', model)
    n = 0
    do i = 1, size(model%equations)
      if (size(model%equations(i)%node) == 1) n = n + 1
    end do
    call suite%that('three equations for each node', n == 9)
    call suite%that('no truss in the plane', .not. any(model%mesh%is_in_plane))
  end subroutine check_plane_beams


  !> What is refused.
  subroutine check_errors()
    call expect_message(B32 // section('PIPE', '.3,.4'), 'must not be thicker than its radius')
    call expect_message(B32 // section('PIPE', '.3,-.1'), 'dimensions must be positive')
    call expect_message(B32 // section('CIRC', '0.'), 'dimensions must be positive')
    call expect_message(B32 // section('BOX', '1.,2.,.6,.2,.6,.4'), 'Opposite walls of a box', DIALECT_CALCULIX)
    call expect_message(B32 // section('ELBOW', '1.,1.'), 'any other is *BEAM GENERAL SECTION')
    call expect_message(B32 // '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;.1,.2;0,0,0;', 'direction must not be zero')
    call expect_message(B32 // '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;', 'needs a data line')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_beams
